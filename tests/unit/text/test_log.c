/* SPDX-License-Identifier: MIT */
/* Tests of the log's ring. */
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/text/log.h"

static struct log *log_under_test;
static int pipe_fd[2];
static char text[1 << 20];

void setUp(void)
{
	log_under_test = log_create(LOG_LEVEL_INFO);
	TEST_ASSERT_NOT_NULL(log_under_test);
	TEST_ASSERT_EQUAL(0, pipe(pipe_fd));
	TEST_ASSERT_EQUAL(0, fcntl(pipe_fd[0], F_SETFL, O_NONBLOCK));
	TEST_ASSERT_EQUAL(0, fcntl(pipe_fd[1], F_SETFL, O_NONBLOCK));
}

void tearDown(void)
{
	log_destroy(log_under_test);
	close(pipe_fd[0]);
	close(pipe_fd[1]);
}

static const char *written(void)
{
	size_t len = 0;
	ssize_t n;

	while (len < sizeof(text) - 1 &&
	       (n = read(pipe_fd[0], text + len, sizeof(text) - 1 - len)) > 0)
		len += (size_t)n;
	text[len] = '\0';
	return text;
}

static void test_lines_come_out_in_order_with_a_newline_each(void)
{
	log_put(log_under_test, LOG_LEVEL_ERR, "first %d", 1);
	log_put(log_under_test, LOG_LEVEL_INFO, "second");
	TEST_ASSERT_EQUAL(2, log_drain(log_under_test, pipe_fd[1], 0));
	TEST_ASSERT_EQUAL_STRING("first 1\nsecond\n", written());
	TEST_ASSERT_EQUAL(0, log_drain(log_under_test, pipe_fd[1], 0));
}

static char seen[64];

static void see(void *ctx, int64_t time_ns, enum log_level level, const char *line, size_t len)
{
	TEST_ASSERT_EQUAL_PTR(&seen, ctx);
	TEST_ASSERT_GREATER_THAN_INT64(0, time_ns);
	snprintf(seen, sizeof(seen), "%d %.*s", level, (int)len, line);
}

static void test_a_line_is_shown_as_it_is_written(void)
{
	log_show(log_under_test, see, &seen);
	log_put(log_under_test, LOG_LEVEL_WARNING, "odd");
	TEST_ASSERT_EQUAL_STRING("", seen);
	log_drain(log_under_test, pipe_fd[1], 1);
	TEST_ASSERT_EQUAL_STRING("4 odd", seen);
	log_show(log_under_test, NULL, NULL);
	log_put(log_under_test, LOG_LEVEL_WARNING, "even");
	log_drain(log_under_test, pipe_fd[1], 1);
	TEST_ASSERT_EQUAL_STRING("4 odd", seen);
}

static void test_levels_are_prefixed_for_the_journal(void)
{
	log_put(log_under_test, LOG_LEVEL_WARNING, "w");
	log_put(log_under_test, LOG_LEVEL_INFO, "i");
	log_drain(log_under_test, pipe_fd[1], 1);
	TEST_ASSERT_EQUAL_STRING("<4>w\n<6>i\n", written());
}

static void test_lines_above_the_level_are_not_made(void)
{
	int evaluated = 0;

	log_debug(log_under_test, "%d", ++evaluated);
	log_put(log_under_test, LOG_LEVEL_DEBUG, "no");
	TEST_ASSERT_EQUAL(0, evaluated);
	TEST_ASSERT_EQUAL(0, log_drain(log_under_test, pipe_fd[1], 0));
}

static void test_no_log_is_no_error(void)
{
	struct log *none = NULL;
	int evaluated = 0;

	log_put(none, LOG_LEVEL_ERR, "nowhere");
	log_err(none, "%d", ++evaluated);
	TEST_ASSERT_EQUAL(0, evaluated);
}

static void test_control_characters_become_question_marks(void)
{
	log_put(log_under_test, LOG_LEVEL_ERR, "a\nb\033[2Jc\x7f");
	log_drain(log_under_test, pipe_fd[1], 0);
	TEST_ASSERT_EQUAL_STRING("a?b?[2Jc?\n", written());
}

static void test_a_long_line_is_cut_at_255_bytes(void)
{
	char big[400];

	memset(big, 'x', sizeof(big) - 1);
	big[sizeof(big) - 1] = '\0';
	log_put(log_under_test, LOG_LEVEL_ERR, "%s", big);
	log_drain(log_under_test, pipe_fd[1], 0);
	TEST_ASSERT_EQUAL_size_t(256, strlen(written()));
}

static void test_a_cut_leaves_no_half_character(void)
{
	char big[400];

	for (size_t shift = 0; shift < 3; shift++) {
		size_t len = shift;

		memset(big, 'x', shift);
		for (; len + 3 < 390; len += 3)
			memcpy(big + len, "\xe2\x82\xac", 3);
		big[len] = '\0';
		log_put(log_under_test, LOG_LEVEL_ERR, "%s", big);
		log_drain(log_under_test, pipe_fd[1], 0);
		len = strlen(written()) - 1;
		TEST_ASSERT_EQUAL_size_t(0, (len - shift) % 3);
		TEST_ASSERT_GREATER_THAN(252, len);
	}
}

static void assert_bell_rings(bool rings)
{
	struct pollfd bell = {.fd = log_bell(log_under_test), .events = POLLIN};

	TEST_ASSERT_EQUAL(rings, poll(&bell, 1, 0));
}

static void test_the_bell_rings_from_a_line_to_the_next_drain(void)
{
	assert_bell_rings(false);
	log_put(log_under_test, LOG_LEVEL_DEBUG, "not taken");
	assert_bell_rings(false);
	log_put(log_under_test, LOG_LEVEL_ERR, "1");
	assert_bell_rings(true);
	log_put(log_under_test, LOG_LEVEL_ERR, "2");
	assert_bell_rings(true);
	log_drain(log_under_test, pipe_fd[1], 0);
	assert_bell_rings(false);
	log_put(log_under_test, LOG_LEVEL_ERR, "3");
	assert_bell_rings(true);
}

static void test_lines_that_find_the_ring_full_are_counted_and_said_once(void)
{
	for (int i = 0; i < 300; i++)
		log_put(log_under_test, LOG_LEVEL_ERR, "%d", i);
	TEST_ASSERT_EQUAL_UINT64(44, log_dropped(log_under_test));
	TEST_ASSERT_EQUAL(256, log_drain(log_under_test, pipe_fd[1], 1));
	TEST_ASSERT_NOT_NULL(strstr(written(), "<3>255\n<4>44 log lines lost\n"));
	log_put(log_under_test, LOG_LEVEL_ERR, "after");
	log_drain(log_under_test, pipe_fd[1], 1);
	TEST_ASSERT_EQUAL_STRING("<3>after\n", written());
}

static void test_lines_that_a_full_disk_does_not_take_are_counted_and_said_later(void)
{
	int full = open("/dev/full", O_WRONLY);

	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, full);
	log_put(log_under_test, LOG_LEVEL_ERR, "one");
	log_put(log_under_test, LOG_LEVEL_ERR, "two");
	log_drain(log_under_test, full, 1);
	log_drain(log_under_test, full, 1);
	close(full);
	TEST_ASSERT_EQUAL_UINT64(2, log_dropped(log_under_test));
	log_put(log_under_test, LOG_LEVEL_ERR, "three");
	log_drain(log_under_test, pipe_fd[1], 1);
	TEST_ASSERT_EQUAL_STRING("<3>three\n<4>2 log lines lost\n", written());
}

static void test_the_ring_goes_round_many_times(void)
{
	char expected[16];

	for (int i = 0; i < 10000; i++) {
		log_put(log_under_test, LOG_LEVEL_ERR, "%d", i);
		TEST_ASSERT_EQUAL(1, log_drain(log_under_test, pipe_fd[1], 0));
		snprintf(expected, sizeof(expected), "%d\n", i);
		TEST_ASSERT_EQUAL_STRING(expected, written());
	}
	TEST_ASSERT_EQUAL_UINT64(0, log_dropped(log_under_test));
}

static void test_a_full_descriptor_keeps_the_lines(void)
{
	char fill[4096];
	int lines = 0;

	memset(fill, '.', sizeof(fill));
	while (write(pipe_fd[1], fill, sizeof(fill)) > 0)
		;
	for (int i = 0; i < 100; i++)
		log_put(log_under_test, LOG_LEVEL_ERR, "kept");
	TEST_ASSERT_EQUAL(0, log_drain(log_under_test, pipe_fd[1], 0));
	written();
	TEST_ASSERT_EQUAL(100, log_drain(log_under_test, pipe_fd[1], 0));
	for (const char *at = written(); (at = strstr(at, "kept\n")); at += 5)
		lines++;
	TEST_ASSERT_EQUAL(100, lines);
}

static void test_a_full_pipe_that_blocks_keeps_the_lines_and_does_not_block(void)
{
	char fill[4096];
	int lines = 0;

	memset(fill, '.', sizeof(fill));
	while (write(pipe_fd[1], fill, sizeof(fill)) > 0)
		;
	TEST_ASSERT_EQUAL(0, fcntl(pipe_fd[1], F_SETFL, 0));
	for (int i = 0; i < 300; i++)
		log_put(log_under_test, LOG_LEVEL_ERR, "kept");
	alarm(60);
	TEST_ASSERT_EQUAL(0, log_drain(log_under_test, pipe_fd[1], 0));
	log_finish(log_under_test, pipe_fd[1], 0);
	written();
	TEST_ASSERT_EQUAL(256, log_drain(log_under_test, pipe_fd[1], 0));
	alarm(0);
	for (const char *at = written(); (at = strstr(at, "kept\n")); at += 5)
		lines++;
	TEST_ASSERT_EQUAL(256, lines);
	TEST_ASSERT_NOT_NULL(strstr(text, "44 log lines lost"));
}

static void test_a_closed_descriptor_loses_the_lines_and_ends(void)
{
	log_put(log_under_test, LOG_LEVEL_ERR, "gone");
	TEST_ASSERT_EQUAL(1, log_drain(log_under_test, -1, 0));
	TEST_ASSERT_EQUAL(0, log_drain(log_under_test, -1, 0));
}

#define THREADS 4
#define EACH 5000
static int running;

static void *put_many(void *arg)
{
	int id = *(int *)arg;

	for (int i = 0; i < EACH; i++)
		log_put(log_under_test, LOG_LEVEL_ERR, "%d %d", id, i);
	__atomic_fetch_sub(&running, 1, __ATOMIC_RELEASE);
	return NULL;
}

static void test_several_threads_lose_nothing_unsaid(void)
{
	int ids[THREADS] = {0, 1, 2, 3}, last[THREADS] = {-1, -1, -1, -1};
	pthread_t threads[THREADS];
	uint64_t came = 0;
	FILE *file = tmpfile();

	TEST_ASSERT_NOT_NULL(file);
	__atomic_store_n(&running, THREADS, __ATOMIC_RELEASE);
	for (int i = 0; i < THREADS; i++)
		TEST_ASSERT_EQUAL(0, pthread_create(&threads[i], NULL, put_many, &ids[i]));
	while (__atomic_load_n(&running, __ATOMIC_ACQUIRE) > 0)
		came += (uint64_t)log_drain(log_under_test, fileno(file), 0);
	for (int i = 0; i < THREADS; i++)
		pthread_join(threads[i], NULL);
	came += (uint64_t)log_drain(log_under_test, fileno(file), 0);
	TEST_ASSERT_EQUAL_UINT64(THREADS * EACH, came + log_dropped(log_under_test));

	rewind(file);
	while (fgets(text, sizeof(text), file)) {
		int id, i;

		if (strstr(text, "lost"))
			continue;
		TEST_ASSERT_EQUAL(2, sscanf(text, "%d %d\n", &id, &i));
		TEST_ASSERT_TRUE(id >= 0 && id < THREADS);
		TEST_ASSERT_GREATER_THAN(last[id], i);
		last[id] = i;
		came--;
	}
	TEST_ASSERT_EQUAL_UINT64(0, came);
	fclose(file);
}

static void test_a_repeated_line_is_said_at_powers_of_two(void)
{
	struct log_rate rate = {0};
	uint64_t said[16];
	unsigned n = 0;

	for (uint64_t i = 1; i <= 1000; i++)
		if (log_rate(&rate, (int64_t)i) && n < 16)
			said[n++] = i;
	TEST_ASSERT_EQUAL(10, n);
	for (unsigned i = 0; i < n; i++)
		TEST_ASSERT_EQUAL_UINT64(1u << i, said[i]);
}

static void test_a_repeated_line_is_said_at_least_hourly(void)
{
	const int64_t hour = INT64_C(3600000000000);
	struct log_rate rate = {0};

	for (int i = 0; i < 5; i++)
		log_rate(&rate, 0);
	TEST_ASSERT_EQUAL(0, log_rate(&rate, hour - 1));
	TEST_ASSERT_EQUAL(3, log_rate(&rate, hour));     /* the seventh: fifth to seventh */
	TEST_ASSERT_EQUAL(1, log_rate(&rate, hour + 1)); /* the eighth */
	TEST_ASSERT_EQUAL(0, log_rate(&rate, 2 * hour));
	TEST_ASSERT_EQUAL(2, log_rate(&rate, 2 * hour + 1));
}

static void test_how_often_it_was_not_said_is_told_when_it_is(void)
{
	struct log_rate rate = {0};
	uint64_t told = 0, last = 0;
	char others[LOG_OTHERS];

	for (int i = 0; i < 1024; i++) {
		uint64_t n = log_rate(&rate, 1);

		told += n;
		last = n ? n : last;
	}
	TEST_ASSERT_EQUAL_UINT64(1024, told);
	TEST_ASSERT_EQUAL_STRING(" (512 times since the last such line)", log_others(last, others));
	TEST_ASSERT_EQUAL_STRING("", log_others(1, others));
	TEST_ASSERT_LESS_THAN_size_t(LOG_OTHERS, strlen(log_others(UINT64_MAX, others)));
	TEST_ASSERT_NOT_NULL(strstr(others, "18446744073709551615 times"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_lines_come_out_in_order_with_a_newline_each);
	RUN_TEST(test_a_line_is_shown_as_it_is_written);
	RUN_TEST(test_levels_are_prefixed_for_the_journal);
	RUN_TEST(test_lines_above_the_level_are_not_made);
	RUN_TEST(test_no_log_is_no_error);
	RUN_TEST(test_control_characters_become_question_marks);
	RUN_TEST(test_a_long_line_is_cut_at_255_bytes);
	RUN_TEST(test_a_cut_leaves_no_half_character);
	RUN_TEST(test_the_bell_rings_from_a_line_to_the_next_drain);
	RUN_TEST(test_lines_that_find_the_ring_full_are_counted_and_said_once);
	RUN_TEST(test_lines_that_a_full_disk_does_not_take_are_counted_and_said_later);
	RUN_TEST(test_the_ring_goes_round_many_times);
	RUN_TEST(test_a_full_descriptor_keeps_the_lines);
	RUN_TEST(test_a_full_pipe_that_blocks_keeps_the_lines_and_does_not_block);
	RUN_TEST(test_a_closed_descriptor_loses_the_lines_and_ends);
	RUN_TEST(test_several_threads_lose_nothing_unsaid);
	RUN_TEST(test_a_repeated_line_is_said_at_powers_of_two);
	RUN_TEST(test_a_repeated_line_is_said_at_least_hourly);
	RUN_TEST(test_how_often_it_was_not_said_is_told_when_it_is);
	return UNITY_END();
}
