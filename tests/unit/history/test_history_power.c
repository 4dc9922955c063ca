/* SPDX-License-Identifier: MIT */
/*
 * Power cuts: the file and its log as they are at any moment of a recorder that writes as fast as
 * it can. What is read of them begins as what was recorded, ends somewhere, and has nothing else.
 * POWER_CUTS=500 for more of them.
 */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "tests/unit/aid/past.h"

#define STEP (PAST_S / 4)

static struct past past;

void setUp(void)
{
}

void tearDown(void)
{
}

/* What the room has at step n; each step has a value. */
static double value_of(int64_t n)
{
	return (double)(n * 7919 % 4096) / 16;
}

/* A recorder until it is killed. */
static void record(void)
{
	static char text[300];

	past_begin(&past, 0, PAST_NOON, true);
	for (int64_t n = 1;; n++) {
		past_room(&past, n * STEP, value_of(n));
		memset(text, 'a' + (int)(n % 26), n % 290);
		text[n % 290] = '\0';
		past_title(&past, n * STEP, text);
		if (n % 4 == 0 && history_writer_tick(past.writer, n * STEP))
			_exit(1);
	}
}

/* What is not synced may be anything, and the memory that readers share is gone. */
static void cut(void)
{
	char name[400];
	FILE *log;

	snprintf(name, sizeof(name), "%s/history.sqlite-shm", past.directory);
	unlink(name);
	snprintf(name, sizeof(name), "%s/history.sqlite-wal", past.directory);
	log = past_random(2) ? fopen(name, "a") : NULL;
	for (unsigned i = 0; log && i < past_random(9000); i++)
		fputc((int)past_random(256), log);
	if (log)
		fclose(log);
}

/* Until the log has so many bytes; a minute at most. */
static void wait_for(unsigned bytes)
{
	struct timespec pause = {0, 200000};
	char name[400];
	struct stat log;

	snprintf(name, sizeof(name), "%s/history.sqlite-wal", past.directory);
	for (int i = 0; i < 300000; i++) {
		if (stat(name, &log) == 0 && log.st_size >= bytes)
			return;
		nanosleep(&pause, NULL); /* pace */
	}
}

/* How many values it has. */
static int check(void)
{
	struct ows_history_item *items;
	int count;

	past_begin(&past, PAST_DAY, PAST_NOON, true);
	past_room(&past, PAST_DAY + PAST_S, -1);
	past_end(&past, PAST_DAY + 2 * PAST_S);
	TEST_ASSERT_EQUAL_STRING("", past.said);
	TEST_ASSERT_EQUAL_INT64(1, past_ask(&past, "select count(*) = 1 and min(quick_check) = 'ok'"
	                                           " from pragma_quick_check"));
	count = past_items(&past, PAST_ROOM, &items);
	/* at the end: a gap since the cut, the new value, and the end of it */
	TEST_ASSERT_EQUAL_DOUBLE(-1, items[count - 2].number);
	count -= 2;
	if (count)
		TEST_ASSERT_EQUAL_STRING(ows_history_reason_text(OWS_HISTORY_LOST),
		                         ows_history_reason_text(items[--count].reason));
	for (int i = 0; i < count; i++) {
		TEST_ASSERT_TRUE(items[i].known);
		TEST_ASSERT_INT64_WITHIN(5000, (i + 1) * STEP, items[i].boot_ns);
		TEST_ASSERT_EQUAL_DOUBLE(value_of(i + 1), items[i].number);
	}
	if (count) /* nothing looks as if it had lasted */
		TEST_ASSERT_TRUE(items[count].boot_ns < (count + 1) * STEP + 1000 * PAST_S);
	return count;
}

static void test_at_any_moment_the_file_has_a_prefix_of_what_was_recorded(void)
{
	const char *wanted = getenv("POWER_CUTS");
	int cuts = wanted ? atoi(wanted) : 40, most = 0;

	for (int i = 0; i < cuts; i++) {
		int count;
		pid_t child;

		past_make(&past);
		past.options.flush_ns = (1 + past_random(60)) * PAST_S;
		child = fork();
		if (child == 0)
			record();
		wait_for(i ? past_random(1 << 19) : 1 << 19);
		kill(child, SIGKILL);
		waitpid(child, NULL, 0);
		cut();
		count = check();
		most = count > most ? count : most;
	}
	TEST_ASSERT_TRUE(most > 1000);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_at_any_moment_the_file_has_a_prefix_of_what_was_recorded);
	return UNITY_END();
}
