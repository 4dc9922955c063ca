/* SPDX-License-Identifier: MIT */
/* Tests of what owsd-notify keeps over its end. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/notify/kept.h"

#define NOW 1000

static char directory[] = "/tmp/owsd-kept-XXXXXX", path[sizeof(directory) + 16];
static struct kept kept, other;
static int64_t told, looked;

void setUp(void)
{
	TEST_ASSERT_NOT_NULL(mkdtemp(directory));
	setenv("STATE_DIRECTORY", directory, 1);
	told = looked = NOW;
	TEST_ASSERT_EQUAL_INT(0, kept_open(&kept, NULL, "owsd-notify", "T", NOW, &told, &looked));
}

void tearDown(void)
{
	kept_close(&kept);
	snprintf(path, sizeof(path), "%s/told", directory);
	remove(path);
	snprintf(path, sizeof(path), "%s/lock", directory);
	remove(path);
	rmdir(directory);
	snprintf(directory + sizeof(directory) - 7, 7, "XXXXXX");
}

static void test_a_second_one_is_refused_until_the_first_is_closed(void)
{
	TEST_ASSERT_EQUAL_INT(-EBUSY,
	                      kept_open(&other, NULL, "owsd-notify", "T", NOW, &told, &looked));
	kept_close(&other); /* it closes nothing of the first */
	TEST_ASSERT_EQUAL_INT(-EBUSY,
	                      kept_open(&other, NULL, "owsd-notify", "T", NOW, &told, &looked));
	kept_close(&kept);
	TEST_ASSERT_EQUAL_INT(0, kept_open(&other, NULL, "owsd-notify", "T", NOW, &told, &looked));
	kept_close(&other);
}

static void test_what_is_written_is_read_and_that_of_another_boot_is_not(void)
{
	TEST_ASSERT_EQUAL_INT64(NOW, told); /* there was no file */
	kept_write(&kept, NULL, 700, 600, NOW);
	kept_close(&kept);
	TEST_ASSERT_EQUAL_INT(0, kept_open(&kept, NULL, "owsd-notify", "T", NOW, &told, &looked));
	TEST_ASSERT_EQUAL_INT64(700, told);
	TEST_ASSERT_EQUAL_INT64(600, looked);
	kept.boot++;
	kept_write(&kept, NULL, 800, 600, NOW);
	kept_close(&kept);
	TEST_ASSERT_EQUAL_INT(0, kept_open(&kept, NULL, "owsd-notify", "T", NOW, &told, &looked));
	TEST_ASSERT_EQUAL_INT64(0, told);
	TEST_ASSERT_EQUAL_INT64(0, looked);
}

/* What was told is not known: rather twice than never. */
static void test_with_a_file_that_cannot_be_read_alarms_are_told_again(void)
{
	snprintf(path, sizeof(path), "%s/told", directory);
	for (int damaged = 0; damaged < 2; damaged++) {
		kept_close(&kept);
		if (damaged)
			fclose(fopen(path, "w"));
		else
			TEST_ASSERT_EQUAL_INT(0, symlink("told", path)); /* ELOOP */
		told = looked = NOW;
		TEST_ASSERT_EQUAL_INT(
			0, kept_open(&kept, NULL, "owsd-notify", "T", NOW, &told, &looked));
		TEST_ASSERT_EQUAL_INT64(0, told);
		TEST_ASSERT_EQUAL_INT64(0, looked);
		TEST_ASSERT_EQUAL_INT(0, remove(path));
	}
}

static void test_a_directory_that_comes_late_is_locked_when_it_is_written(void)
{
	char late[sizeof(directory) + 8];

	kept_close(&kept);
	snprintf(late, sizeof(late), "%s/late", directory);
	setenv("STATE_DIRECTORY", late, 1);
	fclose(fopen(late, "w"));
	TEST_ASSERT_EQUAL_INT(0, kept_open(&kept, NULL, "owsd-notify", "T", NOW, &told, &looked));
	TEST_ASSERT_LESS_THAN_INT(0, kept.lock);
	remove(late);
	TEST_ASSERT_EQUAL_INT(0, mkdir(late, 0700));
	kept_write(&kept, NULL, 700, 600, NOW);
	TEST_ASSERT_EQUAL_INT(-EBUSY,
	                      kept_open(&other, NULL, "owsd-notify", "T", NOW, &told, &looked));
	snprintf(path, sizeof(path), "%s/told", late);
	TEST_ASSERT_EQUAL_INT(0, remove(path));
	snprintf(path, sizeof(path), "%s/lock", late);
	TEST_ASSERT_EQUAL_INT(0, remove(path));
	TEST_ASSERT_EQUAL_INT(0, rmdir(late));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_second_one_is_refused_until_the_first_is_closed);
	RUN_TEST(test_what_is_written_is_read_and_that_of_another_boot_is_not);
	RUN_TEST(test_with_a_file_that_cannot_be_read_alarms_are_told_again);
	RUN_TEST(test_a_directory_that_comes_late_is_locked_when_it_is_written);
	return UNITY_END();
}
