/* SPDX-License-Identifier: MIT */
/* Tests of the command line of a face, and of where its socket stands. */
#include <getopt.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/read/load.h"
#include "src/faces/kit/arguments.h"
#include "tests/unit/aid/folder.h"

static const struct face_option none, listens = {'l', "listen", "PATH", "where it listens"};
static struct face_arguments a;

void setUp(void)
{
	folder_dir();
}

void tearDown(void)
{
}

/* Words up to the first NULL, after the name of the program. */
static int start(const struct face_option *own, const char *one, const char *two)
{
	static char words[3][40];
	const char *const given[] = {"owsd-test", one, two};
	char *argv[4] = {NULL};
	int argc = 0;

	for (; argc < 3 && given[argc]; argc++) {
		strncpy(words[argc], given[argc], sizeof(words[argc]) - 1);
		words[argc][strlen(given[argc])] = '\0';
		argv[argc] = words[argc];
	}
	optind = 0;
	return face_start("owsd-test", own, argc, argv, &a);
}

static void test_without_words_it_is_the_instance_of_the_system(void)
{
	TEST_ASSERT_EQUAL_INT(-1, start(&none, NULL, NULL));
	TEST_ASSERT_EQUAL_STRING("OWS", a.instance);
	TEST_ASSERT_EQUAL_STRING(CONFIG_DIR "/OWS.rio", a.file);
	TEST_ASSERT_EQUAL_PTR(a.default_file, a.file);
	TEST_ASSERT_EQUAL_INT(LOG_LEVEL_NOTICE, a.level);
	TEST_ASSERT_FALSE(a.check);
	TEST_ASSERT_NULL(a.option);
}

static void test_the_name_of_the_instance_is_that_of_its_file(void)
{
	TEST_ASSERT_EQUAL_INT(-1, start(&none, "-vn", "attic"));
	TEST_ASSERT_EQUAL_STRING(CONFIG_DIR "/attic.rio", a.file);
	TEST_ASSERT_EQUAL_INT(LOG_LEVEL_NOTICE + 1, a.level);
	TEST_ASSERT_EQUAL_INT(-1, start(&none, "--config=x.rio", "--check"));
	TEST_ASSERT_EQUAL_STRING("x.rio", a.file);
	TEST_ASSERT_TRUE(a.check);
}

static void test_an_option_is_of_the_face_that_has_it(void)
{
	TEST_ASSERT_EQUAL_INT(-1, start(&listens, "-l", "here"));
	TEST_ASSERT_EQUAL_STRING("here", a.option);
	TEST_ASSERT_EQUAL_INT(-1, start(&listens, "--listen", "there"));
	TEST_ASSERT_EQUAL_STRING("there", a.option);
	TEST_ASSERT_EQUAL_INT(FACE_EXIT_USAGE, start(&none, "-l", "here"));
}

static void test_what_is_wrong_ends_it_with_two_and_help_with_none(void)
{
	TEST_ASSERT_EQUAL_INT(FACE_EXIT_USAGE, start(&none, "x.rio", NULL));
	TEST_ASSERT_EQUAL_INT(FACE_EXIT_USAGE, start(&none, "-n", "a/b"));
	TEST_ASSERT_EQUAL_INT(FACE_EXIT_USAGE, start(&none, "-n", ""));
	/* no owsd has such a name: it would be waited for without end */
	TEST_ASSERT_EQUAL_INT(FACE_EXIT_USAGE,
	                      start(&none, "-n", "the_house_of_our_neighbours_at_1_"));
	TEST_ASSERT_EQUAL_INT(FACE_EXIT_USAGE, start(&none, "-n", "my house"));
	TEST_ASSERT_EQUAL_INT(FACE_EXIT_USAGE, start(&none, "-n", NULL));
	TEST_ASSERT_EQUAL_INT(EXIT_SUCCESS, start(&none, "-h", NULL));
	TEST_ASSERT_EQUAL_INT(EXIT_SUCCESS, start(&none, "--version", NULL));
}

static void test_a_file_that_may_not_grow_ends_no_program(void)
{
	TEST_ASSERT_EQUAL_INT(-1, start(&none, NULL, NULL));
	TEST_ASSERT_TRUE(signal(SIGXFSZ, SIG_DFL) == SIG_IGN);
}

static void test_a_socket_stands_beside_the_files_of_owsd(void)
{
	char path[FACE_PATH];

	TEST_ASSERT_EQUAL_INT(-1, start(&none, "-n", "attic"));
	TEST_ASSERT_EQUAL_INT(0, face_socket(&a, "web", path));
	TEST_ASSERT_EQUAL_STRING("/attic.web", strrchr(path, '/'));
	TEST_ASSERT_EQUAL_STRING_LEN(getenv("OWS_DIR"), path, strlen(getenv("OWS_DIR")));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_without_words_it_is_the_instance_of_the_system);
	RUN_TEST(test_the_name_of_the_instance_is_that_of_its_file);
	RUN_TEST(test_an_option_is_of_the_face_that_has_it);
	RUN_TEST(test_what_is_wrong_ends_it_with_two_and_help_with_none);
	RUN_TEST(test_a_file_that_may_not_grow_ends_no_program);
	RUN_TEST(test_a_socket_stands_beside_the_files_of_owsd);
	return UNITY_END();
}
