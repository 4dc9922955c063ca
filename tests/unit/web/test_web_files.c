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
	static const char *const names[] = {"index.html",  "words.js", "secret",
	                                    ".hidden.js",  "link.js",  "deep.js/more.js",
	                                    "words.js.gz", NULL};

	for (const char *const *name = names; *name; name++)
		unlinkat(page, *name, 0);
	unlinkat(page, "deep.js", AT_REMOVEDIR);
	close(page);
	rmdir(folder);
}

static void gives(const char *path, uint64_t size, const char *type)
{
	struct file file;
	int fd = files_find(page, path, true, &file);

	TEST_ASSERT_TRUE_MESSAGE(fd >= 0, path);
	TEST_ASSERT_EQUAL_UINT64(size, file.size);
	TEST_ASSERT_EQUAL_STRING(type, file.type);
	TEST_ASSERT_FALSE(file.gzip);
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
		"/a.js",  "./words.js", "words.js\n", "index.html/a.js", ".js",     "words.js.gz"};
	struct file file;

	put("words.js.gz", "packed");
	for (size_t i = 0; i < sizeof(paths) / sizeof(paths[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(-ENOENT, files_find(page, paths[i], true, &file),
		                              paths[i]);
}

static void test_the_tag_changes_with_the_file(void)
{
	struct file before, after;

	close(files_find(page, "words.js", true, &before));
	put("words.js", "22;");
	close(files_find(page, "words.js", true, &after));
	TEST_ASSERT_TRUE(strcmp(before.tag, after.tag) != 0);
}

static void changed_at(const char *name, time_t at)
{
	const struct timespec times[] = {{.tv_sec = at}, {.tv_sec = at}};

	TEST_ASSERT_EQUAL_INT(0, utimensat(page, name, times, 0));
}

static void test_a_browser_gets_the_packed_file_if_it_takes_it_and_that_is_no_older(void)
{
	struct file plain, packed;

	put("words.js.gz", "gz");
	changed_at("words.js", 1000);
	changed_at("words.js.gz", 1000);
	close(files_find(page, "words.js", false, &plain));
	close(files_find(page, "words.js", true, &packed));
	TEST_ASSERT_FALSE(plain.gzip);
	TEST_ASSERT_TRUE(packed.gzip);
	TEST_ASSERT_EQUAL_STRING("text/javascript; charset=utf-8", packed.type);
	TEST_ASSERT_TRUE(strcmp(plain.tag, packed.tag) != 0); /* also of one size and time */
	changed_at("words.js.gz", 999);
	close(files_find(page, "words.js", true, &packed));
	TEST_ASSERT_FALSE(packed.gzip);
	TEST_ASSERT_EQUAL_STRING(plain.tag, packed.tag);
}

static void test_gzip_is_taken_where_the_header_names_it(void)
{
	static const char *const with[] = {"gzip", "gzip, deflate, br, zstd", "br;q=1.0 , GZIP",
	                                   "deflate,gzip;q=0.5", "gzip ; q=1"};
	static const char *const without[] = {
		"",       "br",      "identity", "gzip;q=0", "gzip; q=0.000, br",
		"x-gzip", "gzipped", "br;gzip"};

	TEST_ASSERT_FALSE(files_takes_gzip(NULL));
	for (size_t i = 0; i < sizeof(with) / sizeof(with[0]); i++)
		TEST_ASSERT_TRUE_MESSAGE(files_takes_gzip(with[i]), with[i]);
	for (size_t i = 0; i < sizeof(without) / sizeof(without[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(files_takes_gzip(without[i]), without[i]);
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
	RUN_TEST(test_a_browser_gets_the_packed_file_if_it_takes_it_and_that_is_no_older);
	RUN_TEST(test_gzip_is_taken_where_the_header_names_it);
	RUN_TEST(test_a_folder_without_a_first_page_is_none);
	return UNITY_END();
}
