/* SPDX-License-Identifier: MIT */
/* The file that --edit begins, and the name of the instance that it has. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/config/read/config.h"
#include "src/config/read/load.h"
#include "src/faces/web/edit.h"

static char dir[] = "/tmp/owsd-edit-XXXXXX", file[64];

void setUp(void)
{
	strcpy(dir + sizeof(dir) - 7, "XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(dir));
	snprintf(file, sizeof(file), "%s/new.rio", dir);
}

void tearDown(void)
{
	unlink(file);
	rmdir(dir);
}

static void test_a_file_that_is_begun_lets_the_page_configure_and_has_no_problem(void)
{
	struct config_report report = {0};
	struct config *config;

	TEST_ASSERT_EQUAL_INT(0, edit_make(file));
	TEST_ASSERT_EQUAL_INT(0, config_load(file, &report, &config));
	TEST_ASSERT_TRUE(config->web.configure);
	TEST_ASSERT_FALSE(config->web.write);
	config_free(config);
}

static void test_a_file_that_is_there_stays_as_it_is(void)
{
	struct stat before, after;

	TEST_ASSERT_EQUAL_INT(0, edit_make(file));
	TEST_ASSERT_EQUAL_INT(0, truncate(file, 3));
	TEST_ASSERT_EQUAL_INT(0, stat(file, &before));
	TEST_ASSERT_EQUAL_INT(0, edit_make(file));
	TEST_ASSERT_EQUAL_INT(0, stat(file, &after));
	TEST_ASSERT_EQUAL_INT64(before.st_size, after.st_size);
	TEST_ASSERT_EQUAL_INT(-ENOENT, edit_make("/nowhere/new.rio"));
}

static void test_an_instance_has_the_name_of_its_file(void)
{
	static const char *const cases[][2] = {
		{"new.rio", "new"},        {"/home/x/house.rio", "house"}, {"house", "house"},
		{"a.b.rio", "a.b"},        {"./my house.rio", "edit"},     {".rio", "edit"},
		{"/x/.hidden.rio", "edit"}};
	char name[EDIT_NAME];

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		edit_name(cases[i][0], name);
		TEST_ASSERT_EQUAL_STRING(cases[i][1], name);
	}
}

static void test_without_the_option_the_command_line_stays(void)
{
	char program[] = "owsd-web", verbose[] = "-v";
	char *given[] = {program, verbose, NULL}, **argv = given;
	int argc = 2;

	TEST_ASSERT_TRUE(edit_begin(&argc, &argv));
	TEST_ASSERT_EQUAL_INT(2, argc);
	TEST_ASSERT_EQUAL_PTR(given, argv);
	TEST_ASSERT_FALSE(edit_is_on());
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_file_that_is_begun_lets_the_page_configure_and_has_no_problem);
	RUN_TEST(test_a_file_that_is_there_stays_as_it_is);
	RUN_TEST(test_an_instance_has_the_name_of_its_file);
	RUN_TEST(test_without_the_option_the_command_line_stays);
	return UNITY_END();
}
