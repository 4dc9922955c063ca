/* SPDX-License-Identifier: MIT */
/* Tests of the thread that does jobs: whose turn it is, and who has to wait. */
#include "unity.h"

#include <semaphore.h>
#include <stdlib.h>
#include <unistd.h>

#include "hal/base/bell.h"
#include "src/faces/web/jobs.h"

static struct jobs *jobs;
static int bell;
static sem_t begun, may_end;
static uint64_t done[2 * JOBS];
static unsigned count;

static void run(struct job *job)
{
	done[count++] = job->peer;
}

static void run_long(struct job *job)
{
	(void)job;
	sem_post(&begun);
	sem_wait(&may_end);
}

static bool give(uint64_t peer, void (*what)(struct job *job))
{
	struct job *job = calloc(1, sizeof(*job));

	job->peer = peer;
	job->run = what;
	if (jobs_give(jobs, job))
		return true;
	job_free(job);
	return false;
}

/* One job is under way, so that all others wait. */
void setUp(void)
{
	count = 0;
	sem_init(&begun, 0, 0);
	sem_init(&may_end, 0, 0);
	bell = bell_open();
	jobs = jobs_start(bell);
	TEST_ASSERT_NOT_NULL(jobs);
	TEST_ASSERT_TRUE(give(0, run_long));
	sem_wait(&begun);
}

static void finish(unsigned expected)
{
	struct job *job;

	sem_post(&may_end);
	while (expected)
		while ((job = jobs_take(jobs))) {
			job_free(job);
			expected--;
		}
}

void tearDown(void)
{
	jobs_end(jobs);
	jobs_free(jobs);
	close(bell);
	sem_destroy(&begun);
	sem_destroy(&may_end);
}

static void test_a_peer_that_asks_for_much_delays_another_by_one_job(void)
{
	for (int i = 0; i < JOBS_OF_PEER; i++)
		TEST_ASSERT_TRUE(give(1, run));
	TEST_ASSERT_TRUE(give(2, run));
	TEST_ASSERT_TRUE(give(2, run));
	TEST_ASSERT_TRUE(give(3, run));
	finish(1 + JOBS_OF_PEER + 3);
	TEST_ASSERT_EQUAL_UINT64(1, done[0]);
	TEST_ASSERT_EQUAL_UINT64(2, done[1]);
	TEST_ASSERT_EQUAL_UINT64(3, done[2]);
	TEST_ASSERT_EQUAL_UINT64(1, done[3]);
	TEST_ASSERT_EQUAL_UINT64(2, done[4]);
	TEST_ASSERT_EQUAL_UINT64(1, done[5]);
}

static void test_a_peer_cannot_fill_the_queue(void)
{
	for (int i = 0; i < JOBS_OF_PEER; i++)
		TEST_ASSERT_TRUE(give(1, run));
	TEST_ASSERT_FALSE(give(1, run));
	for (int i = 0; i < JOBS - JOBS_OF_PEER; i++)
		TEST_ASSERT_TRUE(give((uint64_t)(2 + i), run));
	/* it is full for all now */
	TEST_ASSERT_FALSE(give(1000, run));
	finish(1 + JOBS);
	TEST_ASSERT_EQUAL_UINT(JOBS, count);
	TEST_ASSERT_TRUE(give(1, run));
	finish(1);
}

static void test_jobs_of_one_peer_keep_their_order(void)
{
	static const uint64_t peers[] = {5, 6, 5, 6, 5}, order[] = {5, 6, 5, 6, 5};

	for (int i = 0; i < 5; i++)
		TEST_ASSERT_TRUE(give(peers[i], run));
	finish(6);
	TEST_ASSERT_EQUAL_UINT64_ARRAY(order, done, 5);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_peer_that_asks_for_much_delays_another_by_one_job);
	RUN_TEST(test_a_peer_cannot_fill_the_queue);
	RUN_TEST(test_jobs_of_one_peer_keep_their_order);
	return UNITY_END();
}
