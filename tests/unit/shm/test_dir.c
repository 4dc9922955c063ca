/* SPDX-License-Identifier: MIT */
/* Tests of the directory: which directory it is, and which directories are refused. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/shm/dir.h"
#include "src/memory/shm/owner.h"
#include "tests/unit/aid/folder.h"

#define ROOM (DIR_PATH + 40)

static char base[DIR_PATH], path[ROOM];
static struct shm_dir dir;

void setUp(void)
{
	snprintf(base, sizeof(base), "%s", folder_dir()->path);
	unsetenv("XDG_RUNTIME_DIR");
	dir = (struct shm_dir){.fd = -1};
}

void tearDown(void)
{
	dir_close(&dir);
	setenv("OWS_DIR", base, 1);
}

static const char *in_base(const char *name)
{
	snprintf(path, sizeof(path), "%s/%s", base, name);
	return path;
}

static void test_ows_dir_names_the_one_place(void)
{
	char own[DIR_PATH], all[DIRS][DIR_PATH];

	setenv("OWS_DIR", "/srv/signals//", 1);
	setenv("XDG_RUNTIME_DIR", "/run/user/1", 1);
	TEST_ASSERT_EQUAL(0, dir_own(own));
	TEST_ASSERT_EQUAL_STRING("/srv/signals", own);
	TEST_ASSERT_EQUAL(1, dir_list(all));
	TEST_ASSERT_EQUAL_STRING(own, all[0]);
}

static void test_without_it_the_service_has_its_place_and_a_user_his(void)
{
	char own[DIR_PATH], all[DIRS][DIR_PATH], shm[40];

	unsetenv("OWS_DIR");
	setenv("XDG_RUNTIME_DIR", "/run/user/1/", 1);
	TEST_ASSERT_EQUAL(0, dir_own(own));
	if (geteuid() == 0 || owner_is_service()) {
		TEST_ASSERT_EQUAL_STRING("/run/owsd", own);
		TEST_ASSERT_EQUAL(1, dir_list(all));
		return;
	}
	TEST_ASSERT_EQUAL_STRING("/run/user/1/owsd", own);
	TEST_ASSERT_EQUAL(2, dir_list(all));
	TEST_ASSERT_EQUAL_STRING("/run/user/1/owsd", all[0]);
	TEST_ASSERT_EQUAL_STRING("/run/owsd", all[1]);
	snprintf(shm, sizeof(shm), "/dev/shm/owsd-%lu", (unsigned long)geteuid());
	setenv("XDG_RUNTIME_DIR", "not/absolute", 1);
	TEST_ASSERT_EQUAL(0, dir_own(own));
	TEST_ASSERT_EQUAL_STRING(shm, own);
}

static void test_an_ows_dir_that_could_be_a_link_in_disguise_is_refused(void)
{
	static const char *const wrong[] = {"owsd", "./owsd", "/", "//", "/tmp/.", "/tmp/.."};
	char own[DIR_PATH], all[DIRS][DIR_PATH], fault[DIR_FAULT], longest[DIR_PATH + 1];

	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		setenv("OWS_DIR", wrong[i], 1);
		TEST_ASSERT_EQUAL_MESSAGE(-EINVAL, dir_own(own), wrong[i]);
		TEST_ASSERT_EQUAL(-EINVAL, dir_list(all));
		TEST_ASSERT_EQUAL(-EINVAL, dir_make(&dir));
		TEST_ASSERT_NOT_NULL(strstr(dir_fault(&dir, -EINVAL, fault), "OWS_DIR"));
	}
	memset(longest, 'x', sizeof(longest));
	longest[0] = '/';
	longest[DIR_PATH] = '\0';
	setenv("OWS_DIR", longest, 1);
	TEST_ASSERT_EQUAL(-EINVAL, dir_own(own));
	longest[DIR_PATH - 1] = '\0';
	setenv("OWS_DIR", longest, 1);
	TEST_ASSERT_EQUAL(0, dir_own(own));
}

static void test_a_missing_place_is_made_for_all_to_enter_whatever_the_umask(void)
{
	mode_t before = umask(0077);
	struct stat st;

	setenv("OWS_DIR", in_base("new"), 1);
	TEST_ASSERT_EQUAL(0, dir_make(&dir));
	umask(before);
	TEST_ASSERT_EQUAL(0, stat(path, &st));
	TEST_ASSERT_EQUAL(S_IFDIR | 0755, st.st_mode);
	TEST_ASSERT_EQUAL_STRING(path, dir.path);
	dir_close(&dir);
	TEST_ASSERT_EQUAL(0, chmod(path, 0700));
	TEST_ASSERT_EQUAL(0, dir_make(&dir));
	TEST_ASSERT_EQUAL(0, stat(path, &st));
	TEST_ASSERT_EQUAL_MESSAGE(0700, st.st_mode & 0777, "one that is there stays as it is");
	TEST_ASSERT_EQUAL(0, rmdir(path));
}

static void test_only_the_last_directory_is_made(void)
{
	char fault[DIR_FAULT];

	setenv("OWS_DIR", in_base("no/such"), 1);
	TEST_ASSERT_EQUAL(-ENOENT, dir_make(&dir));
	TEST_ASSERT_LESS_THAN(0, dir.fd);
	dir_fault(&dir, -ENOENT, fault);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(fault, "cannot make the directory"), fault);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(fault, path), fault);
}

static void refused_for(const char *why)
{
	char fault[DIR_FAULT];

	TEST_ASSERT_EQUAL(-EPERM, dir_open(path, &dir));
	TEST_ASSERT_LESS_THAN(0, dir.fd);
	dir_fault(&dir, -EPERM, fault);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(fault, why), fault);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(fault, path), fault);
	setenv("OWS_DIR", path, 1);
	TEST_ASSERT_EQUAL_MESSAGE(-EPERM, dir_make(&dir), "nor does owsd take it");
}

static void test_a_place_that_others_may_write_into_is_refused(void)
{
	static const mode_t modes[] = {0777, 0775, 0757, 01777, 02775, 0720};

	TEST_ASSERT_EQUAL(0, mkdir(in_base("open"), 0755));
	for (size_t i = 0; i < sizeof(modes) / sizeof(modes[0]); i++) {
		TEST_ASSERT_EQUAL(0, chmod(path, modes[i]));
		refused_for("others may write into");
	}
	TEST_ASSERT_EQUAL(0, rmdir(path));
}

static void test_a_link_to_a_place_is_refused(void)
{
	TEST_ASSERT_EQUAL(0, symlink(base, in_base("link")));
	refused_for("is a link");
	TEST_ASSERT_EQUAL(0, unlink(path));
	TEST_ASSERT_EQUAL(0, symlink("/nowhere", path));
	refused_for("is a link");
	TEST_ASSERT_EQUAL(0, unlink(path));
}

static void test_what_is_no_directory_is_refused(void)
{
	TEST_ASSERT_EQUAL(0, mkfifo(in_base("pipe"), 0600));
	refused_for("is no directory");
	TEST_ASSERT_EQUAL(0, unlink(path));
}

static void test_the_directory_of_another_user_is_refused(void)
{
	if (geteuid() != 0)
		TEST_IGNORE_MESSAGE("needs root, to give a directory away");
	TEST_ASSERT_EQUAL(0, mkdir(in_base("his"), 0755));
	TEST_ASSERT_EQUAL(0, chown(path, 4711, 4711));
	refused_for("belongs to user 4711");
	TEST_ASSERT_EQUAL(0, rmdir(path));
}

static void test_a_place_that_is_not_there_is_none(void)
{
	TEST_ASSERT_EQUAL(-ENOENT, dir_open(in_base("gone"), &dir));
	TEST_ASSERT_EQUAL_STRING(path, dir.path);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_ows_dir_names_the_one_place);
	RUN_TEST(test_without_it_the_service_has_its_place_and_a_user_his);
	RUN_TEST(test_an_ows_dir_that_could_be_a_link_in_disguise_is_refused);
	RUN_TEST(test_a_missing_place_is_made_for_all_to_enter_whatever_the_umask);
	RUN_TEST(test_only_the_last_directory_is_made);
	RUN_TEST(test_a_place_that_others_may_write_into_is_refused);
	RUN_TEST(test_a_link_to_a_place_is_refused);
	RUN_TEST(test_what_is_no_directory_is_refused);
	RUN_TEST(test_the_directory_of_another_user_is_refused);
	RUN_TEST(test_a_place_that_is_not_there_is_none);
	return UNITY_END();
}
