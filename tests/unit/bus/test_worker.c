/* SPDX-License-Identifier: MIT */
/* Real threads and a real clock: what is bounded here is only that nothing hangs. */
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <time.h>

#include "unity.h"

#include "hal/bus/worker.h"

#define TEMPERATURE "/28.000000000001/temperature"
#define MS INT64_C(1000000)
#define S (1000 * MS)
#define REQUESTS 64

static struct worker *worker;
static struct bus_req req[REQUESTS];
static uint8_t data[REQUESTS][32];
static unsigned answers[REQUESTS], n_answers, n_events;
static uint8_t news[64];
static struct bus_answer last[REQUESTS];
static int rung;

/* What the bell does on the worker's thread, besides ringing. */
enum { RING, BLOCK, WAIT_SHORT, WAIT_LONG, LOOK };
static int at_bell;
static int released, bell_result;
static int64_t bell_waited;
static sigset_t bell_mask;
static char bell_name[16];

static int64_t boottime(void)
{
	struct timespec t;

	clock_gettime(CLOCK_BOOTTIME, &t);
	return (int64_t)t.tv_sec * S + t.tv_nsec;
}

static void nap(void)
{
	nanosleep(&(struct timespec){.tv_nsec = MS}, NULL); /* pace */
}

static void wait_in_bell(int64_t length)
{
	const struct bus_env *env = worker_bus(worker)->env;
	int64_t begun = env->now(env->ctx);

	__atomic_store_n(&at_bell, RING, __ATOMIC_SEQ_CST);
	bell_result = env->wait(env->ctx, -1, 0, begun + length);
	bell_waited = env->now(env->ctx) - begun;
}

static void bell(void *ctx)
{
	/* looked at before it counts: who saw it count may tell the next ring something else */
	int what = __atomic_load_n(&at_bell, __ATOMIC_SEQ_CST);

	/* not the thread for an assertion of Unity's */
	__atomic_add_fetch((int *)ctx, 1, __ATOMIC_SEQ_CST);
	switch (what) {
	case RING:
		break;
	case BLOCK:
		while (!__atomic_load_n(&released, __ATOMIC_SEQ_CST))
			nap();
		break;
	case WAIT_SHORT:
		wait_in_bell(60 * MS);
		break;
	case WAIT_LONG:
		wait_in_bell(3600 * S);
		break;
	case LOOK:
		pthread_sigmask(SIG_SETMASK, NULL, &bell_mask);
		prctl(PR_GET_NAME, bell_name);
		break;
	}
}

static void take(void)
{
	const struct worker_message *message;

	while ((message = worker_next(worker))) {
		if (message->is_event) {
			news[n_events++ % sizeof(news)] = message->event.news;
			continue;
		}
		TEST_ASSERT_LESS_THAN_UINT32(REQUESTS, message->answer.id);
		answers[message->answer.id]++;
		last[message->answer.id] = message->answer;
		n_answers++;
	}
}

static void take_until(unsigned n)
{
	for (int64_t until = boottime() + 60 * S; n_answers < n && boottime() < until; nap())
		take();
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(n, n_answers);
}

static void start(const char *target)
{
	char why[200] = "";
	int err = worker_create(target, "bus-under-test-1", bell, &rung, &worker, why, sizeof(why));

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, err, why);
	TEST_ASSERT_EQUAL_INT(0, worker_start(worker));
}

/* Come up in peace: the null bus tells that it is up. From then on the bell does as told. */
static void start_null(int what)
{
	int64_t until = boottime() + 60 * S;

	start("null:");
	while ((!n_events || !__atomic_load_n(&rung, __ATOMIC_SEQ_CST)) && boottime() < until) {
		take();
		nap();
	}
	TEST_ASSERT_EQUAL_UINT(1, n_events);
	__atomic_store_n(&rung, 0, __ATOMIC_SEQ_CST);
	__atomic_store_n(&at_bell, what, __ATOMIC_SEQ_CST);
}

static int submit(uint32_t id, const char *path)
{
	req[id] = (struct bus_req){.id = id,
	                           .op = BUS_READ,
	                           .path = path,
	                           .data = data[id],
	                           .len = sizeof(data[id]),
	                           .deadline_ns = boottime() + 60 * S};
	return worker_submit(worker, &req[id]);
}

static void submit_when_there_is_room(uint32_t id, const char *path)
{
	int64_t until = boottime() + 60 * S;

	while (submit(id, path)) {
		TEST_ASSERT_LESS_THAN_INT64(until, boottime());
		nap();
	}
}

void setUp(void)
{
	worker = NULL;
	memset(answers, 0, sizeof(answers));
	n_answers = n_events = 0;
	rung = released = bell_result = 0;
	at_bell = RING;
}

void tearDown(void)
{
	if (!worker)
		return;
	__atomic_store_n(&released, 1, __ATOMIC_SEQ_CST);
	TEST_ASSERT_EQUAL_INT(0, worker_stop(worker, 60 * S));
	worker_destroy(worker);
}

static void test_a_request_is_answered_and_the_bell_rings(void)
{
	start("null:");
	TEST_ASSERT_EQUAL_INT(0, submit(7, TEMPERATURE));
	take_until(1);
	TEST_ASSERT_EQUAL_UINT(1, answers[7]);
	TEST_ASSERT_EQUAL_INT(0, last[7].err);
	TEST_ASSERT_EQUAL_MEMORY("21.5", data[7], 4);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(1, __atomic_load_n(&rung, __ATOMIC_SEQ_CST));
}

static void test_requests_one_after_the_other_are_all_answered(void)
{
	start("null:");
	for (unsigned round = 0; round < 20; round++) {
		for (uint32_t id = 0; id < REQUESTS; id++) {
			submit_when_there_is_room(id, TEMPERATURE);
			take();
		}
		take_until((round + 1) * REQUESTS);
	}
	for (uint32_t id = 0; id < REQUESTS; id++)
		TEST_ASSERT_EQUAL_UINT(20, answers[id]);
	TEST_ASSERT_EQUAL_UINT64(0, worker_dropped(worker));
}

static void test_late_and_double_answers_are_passed_on(void)
{
	start("late:seed=3;late=20");
	for (uint32_t id = 0; id < REQUESTS; id++) {
		submit_when_there_is_room(id, id % 2 ? TEMPERATURE : "/twice" TEMPERATURE);
		take();
	}
	take_until(REQUESTS + REQUESTS / 2);
	for (uint32_t id = 0; id < REQUESTS; id++)
		TEST_ASSERT_GREATER_OR_EQUAL_UINT(id % 2 ? 1 : 2, answers[id]);
}

static void test_no_answer_is_lost_when_nobody_takes_them(void)
{
	int64_t until = boottime() + 60 * S;

	start("late:late=0;twice=100");
	for (uint32_t id = 0; id < 48; id++)
		submit_when_there_is_room(id, TEMPERATURE);
	while (worker_stalls(worker) == 0 && boottime() < until)
		nap();
	TEST_ASSERT_GREATER_THAN_UINT64(0, worker_stalls(worker));
	take_until(96);
	for (uint32_t id = 0; id < 48; id++)
		TEST_ASSERT_EQUAL_UINT(2, answers[id]);
}

static void test_events_are_dropped_and_counted_when_nobody_takes_them(void)
{
	int64_t until = boottime() + 60 * S;

	start("late:up=1;down=1");
	while (worker_dropped(worker) == 0 && boottime() < until)
		nap();
	TEST_ASSERT_GREATER_THAN_UINT64(0, worker_dropped(worker));
	TEST_ASSERT_EQUAL_INT(0, submit(1, TEMPERATURE));
	take_until(1);
	TEST_ASSERT_GREATER_THAN_UINT(0, n_events);
}

static void test_a_full_queue_says_so(void)
{
	int refused = 0;

	start_null(BLOCK);
	submit(0, TEMPERATURE);
	while (!__atomic_load_n(&rung, __ATOMIC_SEQ_CST))
		nap();
	for (uint32_t id = 1; id < 10; id++)
		refused += submit(id, TEMPERATURE) == -EAGAIN;
	TEST_ASSERT_EQUAL_INT(8, refused);
	__atomic_store_n(&released, 1, __ATOMIC_SEQ_CST);
	take_until(2);
}

static void test_a_stuck_thread_is_told_and_can_end_later(void)
{
	start_null(BLOCK);
	submit(0, TEMPERATURE);
	while (!__atomic_load_n(&rung, __ATOMIC_SEQ_CST))
		nap();
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, worker_stop(worker, 20 * MS));
	__atomic_store_n(&released, 1, __ATOMIC_SEQ_CST);
	TEST_ASSERT_EQUAL_INT(0, worker_stop(worker, 60 * S));
}

static void test_a_submit_does_not_end_the_wait_for_a_reply(void)
{
	start_null(WAIT_SHORT);
	submit(0, TEMPERATURE);
	while (!__atomic_load_n(&rung, __ATOMIC_SEQ_CST))
		nap();
	submit(1, TEMPERATURE);
	take_until(2);
	TEST_ASSERT_EQUAL_INT(0, bell_result);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(60 * MS, bell_waited);
}

static void test_shutdown_ends_the_wait_for_a_reply(void)
{
	start_null(WAIT_LONG);
	submit(0, TEMPERATURE);
	while (!__atomic_load_n(&rung, __ATOMIC_SEQ_CST))
		nap();
	TEST_ASSERT_EQUAL_INT(0, worker_stop(worker, 60 * S));
	TEST_ASSERT_EQUAL_INT(-ECANCELED, bell_result);
}

static void test_the_thread_has_its_name_and_takes_no_signal(void)
{
	start_null(LOOK);
	submit(0, TEMPERATURE);
	take_until(1);
	TEST_ASSERT_EQUAL_INT(0, worker_stop(worker, 60 * S));
	TEST_ASSERT_EQUAL_STRING("bus-under-test-", bell_name);
	TEST_ASSERT_EQUAL_INT(1, sigismember(&bell_mask, SIGTERM));
	TEST_ASSERT_EQUAL_INT(1, sigismember(&bell_mask, SIGPIPE));
	TEST_ASSERT_EQUAL_INT(1, sigismember(&bell_mask, SIGUSR1));
}

/* The bell may lie in a file that somebody truncated: the kernel kills who blocks that SIGBUS. */
static void test_the_thread_lets_faults_of_its_own_through(void)
{
	at_bell = LOOK;
	start("null:");
	submit(0, TEMPERATURE);
	take_until(1);
	TEST_ASSERT_EQUAL_INT(0, worker_stop(worker, 60 * S));
	TEST_ASSERT_EQUAL_INT(0, sigismember(&bell_mask, SIGBUS));
}

static void take_events_until(unsigned n)
{
	for (int64_t until = boottime() + 60 * S; n_events < n && boottime() < until; nap())
		take();
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(n, n_events);
}

static void test_each_turn_of_a_suspension_is_carried_out_in_order(void)
{
	start_null(RING);
	for (unsigned i = 0; i < 3; i++) {
		worker_suspend(worker, true);
		worker_suspend(worker, true); /* that is what it does */
		worker_suspend(worker, false);
	}
	worker_suspend(worker, true);
	TEST_ASSERT_EQUAL_INT(0, submit(1, TEMPERATURE));
	take_until(1);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, last[1].err);
	worker_suspend(worker, false);
	take_events_until(6); /* up, four times released, up, and what lies between them */
	TEST_ASSERT_EQUAL_INT(0, submit(2, TEMPERATURE));
	take_until(2);
	TEST_ASSERT_EQUAL_INT(0, last[2].err);
	TEST_ASSERT_EQUAL_UINT8(BUS_UP, news[n_events - 1]);
}

static void test_a_worker_may_start_suspended(void)
{
	char why[200] = "";

	TEST_ASSERT_EQUAL_INT(0,
	                      worker_create("null:", "x", bell, &rung, &worker, why, sizeof(why)));
	worker_suspend(worker, true);
	TEST_ASSERT_EQUAL_INT(0, worker_start(worker));
	take_events_until(2);
	TEST_ASSERT_EQUAL_UINT8(BUS_RELEASED, news[0]);
	TEST_ASSERT_EQUAL_UINT8(BUS_BACK, news[1]);
	worker_suspend(worker, false);
	take_events_until(3);
	TEST_ASSERT_EQUAL_UINT8(BUS_UP, news[2]);
}

static void test_a_bad_target_is_refused_with_the_reason(void)
{
	char why[200] = "";

	TEST_ASSERT_EQUAL_INT(-EPROTONOSUPPORT, worker_create("nothing:here", "x", bell, &rung,
	                                                      &worker, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL(strstr(why, "nothing"));
	TEST_ASSERT_NULL(worker);
}

static void test_a_worker_that_never_ran_is_destroyed(void)
{
	char why[200] = "";

	TEST_ASSERT_EQUAL_INT(0,
	                      worker_create("null:", "x", NULL, NULL, &worker, why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(0, worker_stop(worker, 0));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_request_is_answered_and_the_bell_rings);
	RUN_TEST(test_requests_one_after_the_other_are_all_answered);
	RUN_TEST(test_late_and_double_answers_are_passed_on);
	RUN_TEST(test_no_answer_is_lost_when_nobody_takes_them);
	RUN_TEST(test_events_are_dropped_and_counted_when_nobody_takes_them);
	RUN_TEST(test_a_full_queue_says_so);
	RUN_TEST(test_a_stuck_thread_is_told_and_can_end_later);
	RUN_TEST(test_a_submit_does_not_end_the_wait_for_a_reply);
	RUN_TEST(test_shutdown_ends_the_wait_for_a_reply);
	RUN_TEST(test_the_thread_has_its_name_and_takes_no_signal);
	RUN_TEST(test_the_thread_lets_faults_of_its_own_through);
	RUN_TEST(test_each_turn_of_a_suspension_is_carried_out_in_order);
	RUN_TEST(test_a_worker_may_start_suspended);
	RUN_TEST(test_a_bad_target_is_refused_with_the_reason);
	RUN_TEST(test_a_worker_that_never_ran_is_destroyed);
	return UNITY_END();
}
