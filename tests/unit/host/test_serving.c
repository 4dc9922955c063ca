/* SPDX-License-Identifier: MIT */
/* What is counted of workers, over reloads that end some of them. */
#include <stdlib.h>
#include <time.h>

#include "unity.h"

#include "hal/bus/worker.h"
#include "src/daemon/host/serving.h"

#define WORKERS 2

static struct worker *workers[WORKERS];
static struct serving before, after;

static struct worker *make(const char *target)
{
	struct worker *worker = NULL;
	char why[200] = "";

	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0, worker_create(target, "test", NULL, NULL, &worker, why, sizeof(why)), why);
	return worker;
}

/* A target that comes and goes tells so; nobody listens, and its queue gets full. */
void setUp(void)
{
	const struct timespec nap = {.tv_nsec = 1000000};

	workers[0] = make("late:up=1;down=1");
	workers[1] = make("late:");
	TEST_ASSERT_EQUAL_INT(0, worker_start(workers[0]));
	for (int i = 0; i < 60000 && worker_dropped(workers[0]) == 0; i++)
		nanosleep(&nap, NULL); /* pace */
	TEST_ASSERT_EQUAL_INT(0, worker_stop(workers[0], INT64_C(60000000000)));
	TEST_ASSERT_GREATER_THAN_UINT64(0, worker_dropped(workers[0]));
	before = (struct serving){.workers = workers, .worker_count = 2};
}

void tearDown(void)
{
	for (unsigned i = 0; i < WORKERS; i++)
		worker_destroy(workers[i]);
}

/* successors: of each worker of before its number after the reload, -1: it ends. */
static void keep_counts(int *successors)
{
	serving_keep_counts(&after, &before, &(struct adoption){.port_successors = successors});
}

static void test_counts_of_workers_that_a_reload_ends_are_kept(void)
{
	struct serving_counts counts = serving_counts(&before);

	TEST_ASSERT_EQUAL_UINT64(worker_stalls(workers[0]), counts.stalls);
	TEST_ASSERT_GREATER_THAN_UINT64(0, counts.dropped);
	after = (struct serving){.workers = &workers[1], .worker_count = 1};
	keep_counts((int[]){-1, 0});
	TEST_ASSERT_EQUAL_UINT64(counts.stalls, serving_counts(&after).stalls);
	TEST_ASSERT_EQUAL_UINT64(counts.dropped, serving_counts(&after).dropped);
}

static void test_counts_of_workers_that_stay_are_counted_once(void)
{
	uint64_t stalls = serving_counts(&before).stalls;

	after = (struct serving){.workers = workers, .worker_count = 2};
	keep_counts((int[]){0, 1});
	TEST_ASSERT_EQUAL_UINT64(stalls, serving_counts(&after).stalls);
	after = (struct serving){.workers = workers, .worker_count = 1};
	keep_counts((int[]){0, -1});
	TEST_ASSERT_EQUAL_UINT64(stalls, serving_counts(&after).stalls);
	/* and kept over a second one */
	before = after;
	before.before.stalls += 7;
	before.before.unstored = 3;
	keep_counts((int[]){0});
	TEST_ASSERT_EQUAL_UINT64(stalls + 7, serving_counts(&after).stalls);
	TEST_ASSERT_EQUAL_UINT64(3, serving_counts(&after).unstored);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_counts_of_workers_that_a_reload_ends_are_kept);
	RUN_TEST(test_counts_of_workers_that_stay_are_counted_once);
	return UNITY_END();
}
