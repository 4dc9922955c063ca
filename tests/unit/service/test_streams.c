/* SPDX-License-Identifier: MIT */
/* Tests of what a program gets from the one that starts it. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/service/streams.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_no_file_gets_the_number_of_a_stream_that_was_closed(void)
{
	int input = dup(STDIN_FILENO), fd;

	close(STDIN_FILENO);
	TEST_ASSERT_EQUAL_INT(0, standard_open());
	fd = open("/dev/null", O_RDONLY);
	TEST_ASSERT_GREATER_THAN_INT(STDERR_FILENO, fd);
	close(fd);
	dup2(input, STDIN_FILENO);
	close(input);
}

static void test_a_write_beyond_the_limit_of_a_file_fails_and_ends_nothing(void)
{
	struct rlimit before, none;
	FILE *file = tmpfile();
	ssize_t written;

	TEST_ASSERT_NOT_NULL(file);
	TEST_ASSERT_EQUAL_INT(0, standard_open());
	TEST_ASSERT_EQUAL_INT(0, getrlimit(RLIMIT_FSIZE, &before));
	none = (struct rlimit){.rlim_cur = 0, .rlim_max = before.rlim_max};
	setrlimit(RLIMIT_FSIZE, &none);
	errno = 0;
	written = write(fileno(file), "x", 1);
	setrlimit(RLIMIT_FSIZE, &before);
	TEST_ASSERT_EQUAL_INT(-1, written);
	TEST_ASSERT_EQUAL_INT(EFBIG, errno);
	fclose(file);
}

static void test_the_journal_is_known_by_its_stream(void)
{
	unsetenv("JOURNAL_STREAM");
	TEST_ASSERT_FALSE(journal_is_stderr());
	setenv("JOURNAL_STREAM", "1:1", 1);
	TEST_ASSERT_FALSE(journal_is_stderr());
	unsetenv("JOURNAL_STREAM");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_no_file_gets_the_number_of_a_stream_that_was_closed);
	RUN_TEST(test_a_write_beyond_the_limit_of_a_file_fails_and_ends_nothing);
	RUN_TEST(test_the_journal_is_known_by_its_stream);
	return UNITY_END();
}
