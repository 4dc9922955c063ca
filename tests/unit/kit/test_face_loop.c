/* SPDX-License-Identifier: MIT */
/* Tests of the descriptors and the status of a face, and of a program that only checks its file. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>

#include "unity.h"

#include "src/faces/kit/loop.h"
#include "tests/unit/aid/folder.h"

static struct face face;
static int checked, verdict;

void setUp(void)
{
	face = (struct face){.notify.fd = -1, .report_ns = 7, .status = "starting"};
	checked = 0;
}

void tearDown(void)
{
}

static void test_a_face_waits_for_so_many_descriptors_and_no_more(void)
{
	for (int i = 0; i < FACE_DESCRIPTORS; i++)
		TEST_ASSERT_EQUAL_INT(0, face_watch(&face, 100 + i, 1));
	TEST_ASSERT_EQUAL_INT(-ENOSPC, face_watch(&face, 200, 1));
	face_ignore(&face, 300);
	TEST_ASSERT_EQUAL_INT(-ENOSPC, face_watch(&face, 200, 1));
	face_ignore(&face, 100);
	TEST_ASSERT_EQUAL_INT(0, face_watch(&face, 200, 1));
}

static void test_a_descriptor_keeps_its_time_when_another_is_ignored(void)
{
	face_watch(&face, 3, 1);
	face_watch(&face, 4, 1);
	face.came_ns[1] = 9;
	face_ignore(&face, 3);
	TEST_ASSERT_EQUAL_INT64(9, face_came(&face, 4));
	TEST_ASSERT_EQUAL_INT64(0, face_came(&face, 3));
	/* a new descriptor of the same number has not been looked at */
	face_ignore(&face, 4);
	face_watch(&face, 4, 1);
	TEST_ASSERT_EQUAL_INT64(0, face_came(&face, 4));
}

static void test_a_status_is_reported_when_it_is_another(void)
{
	face_status(&face, "%d streams", 3);
	TEST_ASSERT_EQUAL_STRING("3 streams", face.status);
	TEST_ASSERT_EQUAL_INT64(0, face.report_ns);
	face.report_ns = 7;
	face_status(&face, "%d streams", 3);
	TEST_ASSERT_EQUAL_INT64(7, face.report_ns);
}

static int check(const struct face *of)
{
	TEST_ASSERT_NOT_NULL(of->config);
	checked++;
	return verdict;
}

static int check_file(const char *text)
{
	static const struct face_ops ops = {.program = "owsd-test", .check = check};
	char config[] = "-c", only[] = "--check", program[] = "owsd-test", path[DIR_PATH + 32];
	char *argv[] = {program, only, config, path, NULL};
	FILE *file;

	snprintf(path, sizeof(path), "%s/face.rio", folder_dir()->path);
	file = fopen(path, "w");
	TEST_ASSERT_NOT_NULL(file);
	fputs(text, file);
	fclose(file);
	optind = 0;
	return face_main(&ops, 4, argv);
}

static void test_a_file_is_checked_by_owsd_and_then_by_the_face(void)
{
	verdict = 0;
	TEST_ASSERT_EQUAL_INT(EXIT_SUCCESS,
	                      check_file("OwsDrv { TargetName \"localhost:4304\" }\n"));
	verdict = -ENOENT;
	TEST_ASSERT_EQUAL_INT(FACE_EXIT_USAGE,
	                      check_file("OwsDrv { TargetName \"localhost:4304\" }\n"));
	TEST_ASSERT_EQUAL_INT(2, checked);
	TEST_ASSERT_EQUAL_INT(FACE_EXIT_USAGE, check_file("OwsDrv {\n"));
	TEST_ASSERT_EQUAL_INT(2, checked);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_face_waits_for_so_many_descriptors_and_no_more);
	RUN_TEST(test_a_descriptor_keeps_its_time_when_another_is_ignored);
	RUN_TEST(test_a_status_is_reported_when_it_is_another);
	RUN_TEST(test_a_file_is_checked_by_owsd_and_then_by_the_face);
	return UNITY_END();
}
