/* SPDX-License-Identifier: MIT */
/* Tests of the files of the page: what a path may name, and what the browser is told of it. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/web/files.h"

static char folder[] = "/tmp/owsd-files-XXXXXX";
static int page;

static void put(const char *name, const char *text)
{
	int fd = openat(page, name, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);

	TEST_ASSERT_TRUE(fd >= 0);
	TEST_ASSERT_EQUAL_INT(strlen(text), write(fd, text, strlen(text)));
	close(fd);
}

void setUp(void)
{
	snprintf(folder, sizeof(folder), "/tmp/owsd-files-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
	page = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	TEST_ASSERT_TRUE(page >= 0);
	put("index.html", "<p>");
	put("words.js", "1;");
	put("secret", "x");
	put(".hidden.js", "x");
	TEST_ASSERT_EQUAL_INT(0, mkdirat(page, "deep.js", 0755));
	put("deep.js/more.js", "x");
	TEST_ASSERT_EQUAL_INT(0, symlinkat("words.js", page, "link.js"));
}

void tearDown(void)
{
	static const char *const names[] = {"index.html", "words.js",        "secret", ".hidden.js",
	                                    "link.js",    "deep.js/more.js", NULL};

	for (const char *const *name = names; *name; name++)
		unlinkat(page, *name, 0);
	unlinkat(page, "deep.js", AT_REMOVEDIR);
	close(page);
	rmdir(folder);
}

static void gives(const char *path, uint64_t size, const char *type)
{
	uint64_t found = 0;
	const char *said = "";
	char tag[FILES_TAG];
	int fd = files_find(page, path, &found, &said, tag);

	TEST_ASSERT_TRUE_MESSAGE(fd >= 0, path);
	TEST_ASSERT_EQUAL_UINT64(size, found);
	TEST_ASSERT_EQUAL_STRING(type, said);
	close(fd);
}

static void test_a_file_of_the_page_has_its_size_and_type(void)
{
	gives("", 3, "text/html; charset=utf-8");
	gives("index.html", 3, "text/html; charset=utf-8");
	gives("words.js", 2, "text/javascript; charset=utf-8");
	gives("link.js", 2, "text/javascript; charset=utf-8");
}

static void test_no_path_leads_out_of_the_page(void)
{
	static const char *const paths[] = {
		"secret", ".hidden.js", "deep.js",    "deep.js/more.js", "none.js", "../etc/a.js",
		"/a.js",  "./words.js", "words.js\n", "index.html/a.js", ".js"};
	uint64_t size;
	const char *type;
	char tag[FILES_TAG];

	for (size_t i = 0; i < sizeof(paths) / sizeof(paths[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			-ENOENT, files_find(page, paths[i], &size, &type, tag), paths[i]);
}

static void test_the_tag_changes_with_the_file(void)
{
	uint64_t size;
	const char *type;
	char before[FILES_TAG], after[FILES_TAG];

	close(files_find(page, "words.js", &size, &type, before));
	put("words.js", "22;");
	close(files_find(page, "words.js", &size, &type, after));
	TEST_ASSERT_TRUE(strcmp(before, after) != 0);
}

static void test_a_folder_without_a_first_page_is_none(void)
{
	int fd = files_open(folder);

	TEST_ASSERT_TRUE(fd >= 0);
	close(fd);
	unlinkat(page, "index.html", 0);
	TEST_ASSERT_EQUAL_INT(-ENOENT, files_open(folder));
	TEST_ASSERT_EQUAL_INT(-ENOENT, files_open("/tmp/there is none"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_file_of_the_page_has_its_size_and_type);
	RUN_TEST(test_no_path_leads_out_of_the_page);
	RUN_TEST(test_the_tag_changes_with_the_file);
	RUN_TEST(test_a_folder_without_a_first_page_is_none);
	return UNITY_END();
}
