/* SPDX-License-Identifier: MIT */
/* What a worker runs beside owsd-web: here this test itself, which lies beside itself. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/faces/web/child.h"
#include "src/public/ows.h"

#define NAME "test_web_child"

void setUp(void)
{
}

void tearDown(void)
{
}

static int run(struct child *child, const char *mode, int64_t ns)
{
	static const char *argv[] = {NAME, NULL, NULL};

	argv[1] = mode;
	child->argv = argv;
	child->until_ns = ows_now() + ns;
	return child_run(child);
}

static void test_what_it_reads_prints_and_says_is_passed_on_whole(void)
{
	size_t len = 300000;
	char *text = malloc(len);
	struct child child = {.input = text, .input_len = len};

	TEST_ASSERT_NOT_NULL(text);
	for (size_t i = 0; i < len; i++)
		text[i] = (char)('a' + i % 26);
	TEST_ASSERT_EQUAL_INT(0, run(&child, "copy", 60 * NS_PER_S));
	TEST_ASSERT_EQUAL_INT(3, child.status);
	TEST_ASSERT_EQUAL_size_t(len, child.out_len);
	TEST_ASSERT_EQUAL_MEMORY(text, child.out, len);
	TEST_ASSERT_EQUAL_STRING("the reason", child.why);
	free(child.out);
	free(text);
}

static void test_one_that_reads_nothing_is_no_fault(void)
{
	static char text[1 << 20];
	struct child child = {.input = text, .input_len = sizeof(text)};

	TEST_ASSERT_EQUAL_INT(0, run(&child, "leave", 60 * NS_PER_S));
	TEST_ASSERT_EQUAL_INT(0, child.status);
	TEST_ASSERT_EQUAL_STRING("", child.out);
	TEST_ASSERT_EQUAL_STRING("", child.why);
	free(child.out);
}

static void test_one_that_hangs_is_killed_and_one_that_floods_is_refused(void)
{
	struct child child = {0};

	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, run(&child, "hang", NS_PER_S / 5));
	TEST_ASSERT_EQUAL_INT(-1, child.status);
	free(child.out);
	TEST_ASSERT_EQUAL_INT(-E2BIG, run(&child, "flood", 60 * NS_PER_S));
	free(child.out);
}

static void test_a_program_that_is_not_there_is_reported(void)
{
	static const char *const argv[] = {"owsd-nowhere", NULL};
	struct child child = {.argv = argv, .until_ns = ows_now() + NS_PER_S};

	TEST_ASSERT_EQUAL_INT(-ENOENT, child_run(&child));
	free(child.out);
}

static int be_child(const char *mode)
{
	int c;

	if (strcmp(mode, "copy") == 0) {
		while ((c = getchar()) != EOF)
			putchar(c);
		fputs("a warning\n" NAME ": the reason\n", stderr);
		return 3;
	}
	for (unsigned i = 0; strcmp(mode, "flood") == 0 && i < CHILD_OUT / 16; i++)
		puts("again and again and again");
	while (strcmp(mode, "hang") == 0)
		pause();
	return 0;
}

int main(int argc, char **argv)
{
	if (argc == 2)
		return be_child(argv[1]);
	UNITY_BEGIN();
	RUN_TEST(test_what_it_reads_prints_and_says_is_passed_on_whole);
	RUN_TEST(test_one_that_reads_nothing_is_no_fault);
	RUN_TEST(test_one_that_hangs_is_killed_and_one_that_floods_is_refused);
	RUN_TEST(test_a_program_that_is_not_there_is_reported);
	return UNITY_END();
}
