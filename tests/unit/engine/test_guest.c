/* SPDX-License-Identifier: MIT */
/* Tests of guests: requests of the served protocol through the engine. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/daemon/engine/guest.h"
#include "tests/unit/aid/scene.h"

#define T1 "/28.551DDF030000/temperature12"
#define T2 "/28.063BC8040000/temperature12"
#define PIO "/29.B89115000000/PIO.0"

static struct scene s;

/* The guests' side: who waits, who was answered. */
static struct engine_guest guests[32], *waiting[32];
static uint8_t room[32][64];
static unsigned guest_count, waiting_first, waiting_count, answered_count, released_count;
static struct engine_guest *answered[64], *released[64];

static struct engine_guest *take(void *ctx)
{
	(void)ctx;
	return waiting_first < waiting_count ? waiting[waiting_first++] : NULL;
}

static void on_answered(void *ctx, struct engine_guest *guest)
{
	(void)ctx;
	answered[answered_count++] = guest;
}

static void on_released(void *ctx, struct engine_guest *guest)
{
	(void)ctx;
	released[released_count++] = guest;
}

static const struct engine_guests port = {take, on_answered, on_released, NULL};

void setUp(void)
{
	guest_count = waiting_first = waiting_count = answered_count = released_count = 0;
	scene_init(&s);
	s.guests = &port;
}

void tearDown(void)
{
	scene_end(&s);
}

static struct engine_guest *ask(enum bus_op op, int lane, const char *path, const char *text)
{
	struct engine_guest *g = &guests[guest_count];

	*g = (struct engine_guest){.op = op,
	                           .lane = lane,
	                           .path = path,
	                           .fresh = true,
	                           .data = room[guest_count],
	                           .len = sizeof(room[0])};
	if (text) {
		g->len = (uint32_t)strlen(text);
		memcpy(g->data, text, g->len);
	}
	guest_count++;
	waiting[waiting_count++] = g;
	return g;
}

static void test_a_guest_is_answered_with_what_the_bus_has(void)
{
	struct engine_guest *g;

	scene_put(&s, T1, "        21.5", 0);
	scene_start(&s);
	scene_up(&s);
	g = ask(BUS_READ, GUEST_ANY_LANE, T1, NULL);
	scene_run(&s, 10 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, answered_count);
	TEST_ASSERT_EQUAL_PTR(g, answered[0]);
	TEST_ASSERT_EQUAL_INT(0, g->answer.err);
	TEST_ASSERT_EQUAL_UINT(12, g->answer.len);
	TEST_ASSERT_EQUAL_MEMORY("        21.5", g->data, 12);
	TEST_ASSERT_FALSE(g->lent);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "guests"));
}

static void test_a_guest_of_a_target_that_is_down_is_told_at_once(void)
{
	struct engine_guest *g = ask(BUS_READ, GUEST_ANY_LANE, T1, NULL);

	scene_start(&s);
	scene_run(&s, SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, answered_count);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, g->answer.err);
	g = ask(BUS_READ, 7, T1, NULL);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_INT(-ENODEV, g->answer.err);
}

static void test_a_guest_whose_lane_was_counted_before_a_reload_is_not_served(void)
{
	struct engine_guest *g;

	scene_put(&s, T1, "        21.5", 0);
	scene_start(&s);
	scene_up(&s);
	g = ask(BUS_READ, 0, T1, NULL);
	g->generation = s.image.header->generation + 1;
	scene_run(&s, 10 * SCENE_MS);
	TEST_ASSERT_EQUAL_INT(-ENODEV, g->answer.err);
	TEST_ASSERT_EQUAL_UINT32(s.image.header->generation, g->generation);
	g = ask(BUS_READ, 0, T1, NULL);
	g->generation = s.image.header->generation;
	scene_run(&s, 10 * SCENE_MS);
	TEST_ASSERT_EQUAL_INT(0, g->answer.err);
}

/* Inputs that are always due, on a bus that takes one request at a time. */
static void test_neither_the_table_nor_its_guests_are_starved(void)
{
	unsigned reads;

	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put(&s, T1, "        21.5", 0);
	scene_put(&s, T2, "          20", 0);
	s.bus[0].latency_ns = 150 * SCENE_MS;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	reads = s.reads;
	for (int i = 0; i < 4; i++)
		ask(BUS_READ, GUEST_ANY_LANE, T2, NULL);
	scene_run(&s, 4 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(4, answered_count);
	/* 26 requests fit: four are theirs */
	TEST_ASSERT_GREATER_THAN_UINT(15, s.reads - reads - 4);
}

static void test_guests_take_a_part_of_a_deep_bus_only(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put(&s, T1, "        21.5", 0);
	scene_put(&s, T2, "          20", 0);
	s.bus[0].depth = SCENE_DEPTH;
	s.bus[0].slow = T2;
	s.bus[0].slow_ns = 10 * SCENE_S;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 200 * SCENE_MS);
	for (int i = 0; i < 16; i++)
		ask(BUS_READ, GUEST_ANY_LANE, T2, NULL);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT64(SCENE_DEPTH / 4, scene_counter(&s, "guests"));
	/* the table went on meanwhile */
	TEST_ASSERT_GREATER_THAN_UINT32(10, scene_sample(&s, 1).count);
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "late_periods"));
}

static void test_who_is_given_up_is_told_and_gets_his_room_back_later(void)
{
	struct engine_guest *g;
	struct bus_req *req;

	scene_put(&s, T1, "        21.5", 0);
	scene_start(&s);
	scene_up(&s);
	s.bus[0].mute = true;
	g = ask(BUS_READ, GUEST_ANY_LANE, T1, NULL);
	scene_run(&s, s.config.timeout_ns + SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, answered_count);
	TEST_ASSERT_TRUE(g->lent);
	TEST_ASSERT_NOT_EQUAL(0, g->answer.err);
	TEST_ASSERT_EQUAL_UINT(0, released_count);
	req = s.bus[0].swallowed[0];
	scene_answer(&s, req->id, 0, "late", req);
	scene_run(&s, SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, answered_count);
	TEST_ASSERT_EQUAL_UINT(1, released_count);
	TEST_ASSERT_EQUAL_PTR(g, released[0]);
}

static void test_a_long_value_has_as_many_times_the_time_as_it_has_parts(void)
{
	static const char memory[] = "/0C.551DDF030000/memory";
	struct engine_guest *g;

	scene_put(&s, T1, "        21.5", 0);
	scene_put(&s, memory, "8192 bytes", 0);
	s.bus[0].depth = 2;
	scene_start(&s);
	scene_up(&s);
	s.bus[0].slow = memory;
	s.bus[0].slow_ns = 3 * s.config.timeout_ns;
	g = ask(BUS_READ, GUEST_ANY_LANE, memory, NULL);
	g->parts = 4;
	scene_run(&s, s.bus[0].slow_ns + SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, answered_count);
	TEST_ASSERT_EQUAL_INT(0, g->answer.err);
	g = ask(BUS_READ, GUEST_ANY_LANE, memory, NULL);
	g->parts = 2;
	scene_run(&s, s.bus[0].slow_ns + SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, answered_count);
	TEST_ASSERT_NOT_EQUAL(0, g->answer.err);
	TEST_ASSERT_TRUE(g->lent);
}

/* An owserver that hangs would keep all else of the target from its failover for so long. */
static void test_a_bus_that_does_one_thing_at_a_time_has_once_the_time_for_all(void)
{
	static const char memory[] = "/37.551DDF030000/memory";
	struct engine_guest *g;

	scene_put(&s, T1, "        21.5", 0);
	scene_put(&s, memory, "32768 bytes", 0);
	scene_start(&s);
	scene_up(&s);
	s.bus[0].mute = true;
	g = ask(BUS_READ, GUEST_ANY_LANE, memory, NULL);
	g->parts = 32;
	scene_run(&s, s.config.timeout_ns + 2 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, answered_count);
	TEST_ASSERT_NOT_EQUAL(0, g->answer.err);
}

static void test_an_output_over_which_a_guest_wrote_is_written_again(void)
{
	scene_output(&s, "pump", PIO, OWS_BOOL);
	scene_put(&s, PIO, "1", 0);
	scene_put(&s, "/29.B89115000000/PIO.BYTE", "0", 0);
	scene_put(&s, "/29.B89115000000/strobe", "0", 0);
	scene_start(&s);
	scene_set(&s, 1, 1);
	scene_up(&s);
	scene_run(&s, 200 * SCENE_MS);
	scene_clear_trace(&s);
	ask(BUS_WRITE, GUEST_ANY_LANE, "/29.B89115000000/strobe", "0");
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("W /29.B89115000000/strobe=0\n", s.trace);
	scene_clear_trace(&s);
	ask(BUS_WRITE, GUEST_ANY_LANE, "/29.B89115000000/PIO.BYTE", "0");
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("W /29.B89115000000/PIO.BYTE=0\nW " PIO "=1\n", s.trace);
}

/* A set of an input was an event, and what a guest writes is the next one. */
static void test_an_input_over_which_a_guest_wrote_is_left_to_the_next_set(void)
{
	scene_input(&s, "setpoint", PIO, OWS_BOOL)->writable = true;
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_set(&s, 1, 1);
	scene_up(&s);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("1", scene_at(&s, PIO));
	ask(BUS_WRITE, GUEST_ANY_LANE, PIO, "0");
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, PIO));
	scene_set(&s, 1, 1);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("1", scene_at(&s, PIO));
}

/* Nobody waits for what a guest asks that has left; what it writes is written. */
static void test_who_left_is_asked_for_nothing_more_but_what_he_wrote(void)
{
	struct engine_guest *reads, *lists, *writes;

	scene_put(&s, T1, "        21.5", 0);
	scene_put(&s, PIO, "0", 0);
	s.bus[0].latency_ns = 100 * SCENE_MS;
	scene_start(&s);
	scene_up(&s);
	struct engine_guest *first = ask(BUS_READ, GUEST_ANY_LANE, T1, NULL);
	reads = ask(BUS_READ, GUEST_ANY_LANE, T2, NULL);
	lists = ask(BUS_DIR, GUEST_ANY_LANE, "/", NULL);
	writes = ask(BUS_WRITE, GUEST_ANY_LANE, PIO, "1");
	scene_run(&s, 10 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].pending_count);
	const struct bus_req *lent = s.bus[0].pending[0].req;
	TEST_ASSERT_EQUAL_STRING(T1, lent->path);
	TEST_ASSERT_FALSE(bus_req_unwanted(lent));
	first->unwanted = reads->unwanted = lists->unwanted = writes->unwanted = 1;
	TEST_ASSERT_TRUE(bus_req_unwanted(lent));
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(4, answered_count);
	TEST_ASSERT_EQUAL_INT(-ECANCELED, reads->answer.err);
	TEST_ASSERT_EQUAL_INT(-ECANCELED, lists->answer.err);
	TEST_ASSERT_EQUAL_INT(0, writes->answer.err);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].reads);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[0].lists);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].writes);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_guest_is_answered_with_what_the_bus_has);
	RUN_TEST(test_a_guest_of_a_target_that_is_down_is_told_at_once);
	RUN_TEST(test_a_guest_whose_lane_was_counted_before_a_reload_is_not_served);
	RUN_TEST(test_neither_the_table_nor_its_guests_are_starved);
	RUN_TEST(test_guests_take_a_part_of_a_deep_bus_only);
	RUN_TEST(test_who_is_given_up_is_told_and_gets_his_room_back_later);
	RUN_TEST(test_a_long_value_has_as_many_times_the_time_as_it_has_parts);
	RUN_TEST(test_a_bus_that_does_one_thing_at_a_time_has_once_the_time_for_all);
	RUN_TEST(test_an_output_over_which_a_guest_wrote_is_written_again);
	RUN_TEST(test_an_input_over_which_a_guest_wrote_is_left_to_the_next_set);
	RUN_TEST(test_who_left_is_asked_for_nothing_more_but_what_he_wrote);
	return UNITY_END();
}
