/* SPDX-License-Identifier: MIT */
/* Limit alarms: the states of ISA-18.2, conditions, hysteresis and delays. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "unity.h"

#include "src/daemon/engine/limits/limit.h"

#define S INT64_C(1000000000)

static struct config_limits limits;
static struct limit limit;
static struct limit_news news;
static int64_t now;

void setUp(void)
{
	limits = (struct config_limits){
		.any = true,
		.has = {true, true, true, true},
		.limit = {-10, 0, 30, 40},
	};
	limit = (struct limit){0};
	now = 1000 * S;
}

void tearDown(void)
{
}

static void expect_next(enum ows_limit_state state, enum limit_event event,
                        enum ows_limit_state next)
{
	TEST_ASSERT_EQUAL(next, limit_next(state, event));
}

static void test_a_normal_alarm_raised_is_unacknowledged(void)
{
	expect_next(OWS_LIMIT_NORMAL, LIMIT_RAISE, OWS_LIMIT_UNACKNOWLEDGED);
}

static void test_a_normal_alarm_that_returns_stays_normal(void)
{
	expect_next(OWS_LIMIT_NORMAL, LIMIT_RETURN, OWS_LIMIT_NORMAL);
}

static void test_a_normal_alarm_acknowledged_stays_normal(void)
{
	expect_next(OWS_LIMIT_NORMAL, LIMIT_ACKNOWLEDGE, OWS_LIMIT_NORMAL);
}

static void test_an_unacknowledged_alarm_raised_stays_unacknowledged(void)
{
	expect_next(OWS_LIMIT_UNACKNOWLEDGED, LIMIT_RAISE, OWS_LIMIT_UNACKNOWLEDGED);
}

static void test_an_unacknowledged_alarm_that_returns_waits_to_be_acknowledged(void)
{
	expect_next(OWS_LIMIT_UNACKNOWLEDGED, LIMIT_RETURN, OWS_LIMIT_RETURNED);
}

static void test_an_unacknowledged_alarm_acknowledged_is_acknowledged(void)
{
	expect_next(OWS_LIMIT_UNACKNOWLEDGED, LIMIT_ACKNOWLEDGE, OWS_LIMIT_ACKNOWLEDGED);
}

static void test_an_acknowledged_alarm_raised_is_unacknowledged_again(void)
{
	expect_next(OWS_LIMIT_ACKNOWLEDGED, LIMIT_RAISE, OWS_LIMIT_UNACKNOWLEDGED);
}

static void test_an_acknowledged_alarm_that_returns_is_normal(void)
{
	expect_next(OWS_LIMIT_ACKNOWLEDGED, LIMIT_RETURN, OWS_LIMIT_NORMAL);
}

static void test_an_acknowledged_alarm_acknowledged_stays_so(void)
{
	expect_next(OWS_LIMIT_ACKNOWLEDGED, LIMIT_ACKNOWLEDGE, OWS_LIMIT_ACKNOWLEDGED);
}

static void test_a_returned_alarm_raised_is_unacknowledged(void)
{
	expect_next(OWS_LIMIT_RETURNED, LIMIT_RAISE, OWS_LIMIT_UNACKNOWLEDGED);
}

static void test_a_returned_alarm_that_returns_stays_returned(void)
{
	expect_next(OWS_LIMIT_RETURNED, LIMIT_RETURN, OWS_LIMIT_RETURNED);
}

static void test_a_returned_alarm_acknowledged_is_normal(void)
{
	expect_next(OWS_LIMIT_RETURNED, LIMIT_ACKNOWLEDGE, OWS_LIMIT_NORMAL);
}

static int64_t see(const struct limit_reading *reading)
{
	return limit_evaluate(&limit, &limits, reading, now, &news);
}

static int64_t value(double number)
{
	return see(&(struct limit_reading){.value = number});
}

static void expect(enum ows_limit_state state, uint8_t kind, uint8_t returned, uint8_t raised)
{
	TEST_ASSERT_EQUAL(state, limit.state);
	TEST_ASSERT_EQUAL(kind, limit.kind);
	TEST_ASSERT_EQUAL(returned, news.returned);
	TEST_ASSERT_EQUAL(raised, news.raised);
}

static void test_each_limit_raises_its_kind(void)
{
	static const struct {
		double value;
		uint8_t kind;
	} cases[] = {
		{-10.1, OWS_ALARM_LL},
		{-10, OWS_ALARM_LL},
		{-9.9, OWS_ALARM_L},
		{0, OWS_ALARM_L},
		{0.1, 0},
		{29.9, 0},
		{30, OWS_ALARM_H},
		{39.9, OWS_ALARM_H},
		{40, OWS_ALARM_HH},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		limit = (struct limit){0};
		TEST_ASSERT_EQUAL_INT64(INT64_MAX, value(cases[i].value));
		expect(cases[i].kind ? OWS_LIMIT_UNACKNOWLEDGED : OWS_LIMIT_NORMAL, cases[i].kind,
		       0, cases[i].kind);
	}
}

static void test_a_limit_that_is_not_given_raises_nothing(void)
{
	memset(limits.has, 0, sizeof(limits.has));
	value(-1e9);
	expect(OWS_LIMIT_NORMAL, 0, 0, 0);
	value(1e9);
	expect(OWS_LIMIT_NORMAL, 0, 0, 0);
}

static void test_an_alarm_is_raised_once(void)
{
	value(31);
	value(32);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, 0, 0);
}

static void test_the_whole_life_of_an_alarm(void)
{
	value(31);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, 0, OWS_ALARM_H);
	TEST_ASSERT_EQUAL(OWS_ALARM_H, limit_acknowledge(&limit));
	value(31);
	expect(OWS_LIMIT_ACKNOWLEDGED, OWS_ALARM_H, 0, 0);
	value(20);
	expect(OWS_LIMIT_NORMAL, 0, OWS_ALARM_H, 0);
	TEST_ASSERT_EQUAL(0, limit_acknowledge(&limit));
}

static void test_a_returned_alarm_keeps_its_kind_until_it_is_acknowledged(void)
{
	value(45);
	value(20);
	expect(OWS_LIMIT_RETURNED, OWS_ALARM_HH, OWS_ALARM_HH, 0);
	value(21);
	expect(OWS_LIMIT_RETURNED, OWS_ALARM_HH, 0, 0);
	TEST_ASSERT_EQUAL(OWS_ALARM_HH, limit_acknowledge(&limit));
	TEST_ASSERT_EQUAL(OWS_LIMIT_NORMAL, limit.state);
	TEST_ASSERT_EQUAL(0, limit.kind);
}

static void test_from_high_to_high_high_it_is_unacknowledged_again(void)
{
	value(31);
	limit_acknowledge(&limit);
	value(41);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_HH, 0, OWS_ALARM_HH);
}

static void test_from_high_high_to_high_nothing_is_raised(void)
{
	value(41);
	limit_acknowledge(&limit);
	value(31);
	expect(OWS_LIMIT_ACKNOWLEDGED, OWS_ALARM_H, OWS_ALARM_HH, 0);
}

static void test_from_high_to_low_it_is_raised_anew(void)
{
	value(31);
	limit_acknowledge(&limit);
	value(-1);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_L, OWS_ALARM_H, OWS_ALARM_L);
}

static void test_hysteresis_holds_an_alarm_but_does_not_raise_it(void)
{
	limits.hysteresis = 2;
	value(29);
	expect(OWS_LIMIT_NORMAL, 0, 0, 0);
	value(30);
	value(28);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, 0, 0);
	value(27.9);
	expect(OWS_LIMIT_RETURNED, OWS_ALARM_H, OWS_ALARM_H, 0);
	value(0);
	value(2);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_L, 0, 0);
	value(2.1);
	expect(OWS_LIMIT_RETURNED, OWS_ALARM_L, OWS_ALARM_L, 0);
}

static void test_an_alarm_is_raised_after_its_on_delay(void)
{
	limits.on_delay_ns = 5 * S;
	TEST_ASSERT_EQUAL_INT64(now + 5 * S, value(31));
	expect(OWS_LIMIT_NORMAL, 0, 0, 0);
	now += 5 * S - 1;
	TEST_ASSERT_EQUAL_INT64(now + 1, value(31));
	expect(OWS_LIMIT_NORMAL, 0, 0, 0);
	now += 1;
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, value(31));
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, 0, OWS_ALARM_H);
}

static void test_an_on_delay_begins_anew_when_the_value_was_inside(void)
{
	limits.on_delay_ns = 5 * S;
	value(31);
	now += 4 * S;
	value(20);
	now += S;
	TEST_ASSERT_EQUAL_INT64(now + 5 * S, value(31));
	expect(OWS_LIMIT_NORMAL, 0, 0, 0);
}

static void test_on_the_way_up_each_limit_has_its_own_delay(void)
{
	limits.on_delay_ns = 5 * S;
	value(31);
	now += 3 * S;
	TEST_ASSERT_EQUAL_INT64(now + 2 * S, value(41));
	now += 2 * S;
	TEST_ASSERT_EQUAL_INT64(now + 3 * S, value(41));
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, 0, OWS_ALARM_H);
	now += 3 * S;
	value(41);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_HH, 0, OWS_ALARM_HH);
}

static void test_an_alarm_returns_after_its_off_delay(void)
{
	limits.off_delay_ns = 5 * S;
	value(31);
	TEST_ASSERT_EQUAL_INT64(now + 5 * S, value(20));
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, 0, 0);
	now += 4 * S;
	value(31);
	now += 2 * S;
	value(20);
	now += 5 * S;
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, value(20));
	expect(OWS_LIMIT_RETURNED, OWS_ALARM_H, OWS_ALARM_H, 0);
}

static void test_a_bad_value_is_an_alarm_of_its_own(void)
{
	see(&(struct limit_reading){.bad = true});
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_BAD, 0, OWS_ALARM_BAD);
	value(20);
	expect(OWS_LIMIT_RETURNED, OWS_ALARM_BAD, OWS_ALARM_BAD, 0);
}

static void test_a_stale_value_is_an_alarm_of_its_own(void)
{
	see(&(struct limit_reading){.value = 20, .stale = true});
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_STALE, 0, OWS_ALARM_STALE);
	value(20);
	expect(OWS_LIMIT_RETURNED, OWS_ALARM_STALE, OWS_ALARM_STALE, 0);
}

static void test_a_value_never_read_is_no_alarm(void)
{
	see(&(struct limit_reading){.value = -50, .unknown = true});
	expect(OWS_LIMIT_NORMAL, 0, 0, 0);
}

static void test_an_alarm_of_the_value_stands_while_the_value_is_not_known(void)
{
	value(31);
	limit_acknowledge(&limit);
	see(&(struct limit_reading){.value = 20, .bad = true});
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_BAD, 0, OWS_ALARM_BAD);
	limit_acknowledge(&limit);
	value(31);
	expect(OWS_LIMIT_ACKNOWLEDGED, OWS_ALARM_H, OWS_ALARM_BAD, 0);
	value(20);
	expect(OWS_LIMIT_NORMAL, 0, OWS_ALARM_H, 0);
}

static void test_no_delay_of_the_value_runs_while_it_is_not_known(void)
{
	limits.on_delay_ns = 5 * S;
	limits.off_delay_ns = 5 * S;
	value(31);
	now += 4 * S;
	see(&(struct limit_reading){.bad = true});
	now += 2 * S;
	see(&(struct limit_reading){.bad = true});
	expect(OWS_LIMIT_NORMAL, 0, 0, 0);
	value(31);
	now += 5 * S;
	value(31);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, 0, OWS_ALARM_H);
	value(20);
	now += S;
	see(&(struct limit_reading){.stale = true});
	now += 4 * S;
	see(&(struct limit_reading){.stale = true});
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, 0, 0);
}

static void test_a_kind_of_high_rank_hides_one_that_is_raised_under_it(void)
{
	limits.off_delay_ns = 5 * S;
	see(&(struct limit_reading){.bad = true});
	limit_acknowledge(&limit);
	value(31);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_BAD, 0, OWS_ALARM_H);
	now += 5 * S;
	value(31);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, OWS_ALARM_BAD, 0);
}

/* Put the alarm into a state of the diagram of ISA-18.2; HH is active where one stands. */
static void put(enum ows_limit_state state)
{
	limit = (struct limit){0};
	if (state != OWS_LIMIT_NORMAL)
		value(45);
	if (state == OWS_LIMIT_ACKNOWLEDGED)
		limit_acknowledge(&limit);
	if (state == OWS_LIMIT_RETURNED)
		value(20);
	TEST_ASSERT_EQUAL(state, limit.state);
}

static void test_from_each_state_shelving_leads_to_no_alarm_that_is_shown(void)
{
	for (int state = OWS_LIMIT_NORMAL; state <= OWS_LIMIT_RETURNED; state++) {
		bool stands = state == OWS_LIMIT_UNACKNOWLEDGED || state == OWS_LIMIT_ACKNOWLEDGED;

		put((enum ows_limit_state)state);
		limit_shelve(&limit);
		TEST_ASSERT_TRUE(limit.shelved);
		TEST_ASSERT_EQUAL(OWS_LIMIT_NORMAL, limit.state);
		TEST_ASSERT_EQUAL(stands ? OWS_ALARM_HH : 0, limit.kind);
	}
}

static void test_from_each_state_an_alarm_that_is_unshelved_is_raised_if_it_stands(void)
{
	for (int state = OWS_LIMIT_NORMAL; state <= OWS_LIMIT_RETURNED; state++) {
		bool stands = state == OWS_LIMIT_UNACKNOWLEDGED || state == OWS_LIMIT_ACKNOWLEDGED;

		put((enum ows_limit_state)state);
		limit_shelve(&limit);
		TEST_ASSERT_EQUAL(stands ? OWS_ALARM_HH : 0, limit_unshelve(&limit));
		TEST_ASSERT_FALSE(limit.shelved);
		TEST_ASSERT_EQUAL(stands ? OWS_LIMIT_UNACKNOWLEDGED : OWS_LIMIT_NORMAL,
		                  limit.state);
	}
}

static void test_a_shelved_alarm_is_neither_raised_nor_returned(void)
{
	limit_shelve(&limit);
	value(31);
	expect(OWS_LIMIT_NORMAL, OWS_ALARM_H, 0, 0);
	value(45);
	expect(OWS_LIMIT_NORMAL, OWS_ALARM_HH, 0, 0);
	see(&(struct limit_reading){.bad = true});
	expect(OWS_LIMIT_NORMAL, OWS_ALARM_BAD, 0, 0);
	value(20);
	expect(OWS_LIMIT_NORMAL, 0, 0, 0);
	TEST_ASSERT_EQUAL(0, limit_unshelve(&limit));
}

static void test_a_shelved_alarm_cannot_be_acknowledged(void)
{
	value(31);
	limit_shelve(&limit);
	TEST_ASSERT_EQUAL(0, limit_acknowledge(&limit));
	TEST_ASSERT_EQUAL(OWS_ALARM_H, limit.kind);
	TEST_ASSERT_EQUAL(OWS_ALARM_H, limit_unshelve(&limit));
	TEST_ASSERT_EQUAL(OWS_LIMIT_UNACKNOWLEDGED, limit.state);
}

static void test_delays_run_while_an_alarm_is_shelved(void)
{
	limits.on_delay_ns = 5 * S;
	limit_shelve(&limit);
	TEST_ASSERT_EQUAL_INT64(now + 5 * S, value(31));
	now += 4 * S;
	value(31);
	TEST_ASSERT_EQUAL(0, limit_unshelve(&limit));
	now += S;
	value(31);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, 0, OWS_ALARM_H);
}

static void test_what_is_not_shelved_stays_as_it_is_when_it_is_unshelved(void)
{
	value(31);
	limit_acknowledge(&limit);
	TEST_ASSERT_EQUAL(0, limit_unshelve(&limit));
	TEST_ASSERT_EQUAL(OWS_LIMIT_ACKNOWLEDGED, limit.state);
}

/* Whatever happens: the state fits what is active, and a delay that runs is asked for. */
static void test_the_state_fits_the_conditions_whatever_comes(void)
{
	unsigned seed = (unsigned)time(NULL), raised = 0;
	char message[32];
	int64_t next;

	snprintf(message, sizeof(message), "seed %u", seed);
	limits.hysteresis = 3;
	srand(seed);
	for (int i = 0; i < 100000; i++) {
		struct limit_reading reading = {
			.value = rand() % 80 - 20,
			.bad = rand() % 16 == 0,
			.stale = rand() % 16 == 0,
		};
		struct limit was;

		limits.on_delay_ns = i / 1000 % 3 * S;
		limits.off_delay_ns = i / 3000 % 3 * S;
		now += rand() % (2 * S);
		if (rand() % 8 == 0)
			limit_acknowledge(&limit);
		if (rand() % 64 == 0)
			limit_shelve(&limit);
		if (rand() % 32 == 0)
			limit_unshelve(&limit);
		was = limit;
		next = see(&reading);
		raised += news.raised != 0;
		TEST_ASSERT_TRUE_MESSAGE(next > now, message);
		TEST_ASSERT_EQUAL_MESSAGE((limit.in ^ limit.active) != 0, next != INT64_MAX,
		                          message);
		if (limit.shelved) {
			TEST_ASSERT_EQUAL_MESSAGE(OWS_LIMIT_NORMAL, limit.state, message);
			TEST_ASSERT_EQUAL_MESSAGE(limit.active == 0, limit.kind == 0, message);
			TEST_ASSERT_EQUAL_MESSAGE(0, news.raised + news.returned, message);
			continue;
		}
		TEST_ASSERT_EQUAL_MESSAGE(limit.active != 0,
		                          limit.state == OWS_LIMIT_UNACKNOWLEDGED ||
		                                  limit.state == OWS_LIMIT_ACKNOWLEDGED,
		                          message);
		TEST_ASSERT_EQUAL_MESSAGE(limit.state == OWS_LIMIT_NORMAL, limit.kind == 0,
		                          message);
		TEST_ASSERT_TRUE_MESSAGE(!news.raised || limit.state == OWS_LIMIT_UNACKNOWLEDGED,
		                         message);
		TEST_ASSERT_EQUAL_MESSAGE((limit.active & ~was.active) != 0, news.raised != 0,
		                          message);
	}
	TEST_ASSERT_GREATER_THAN_MESSAGE(100, raised, message);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_normal_alarm_raised_is_unacknowledged);
	RUN_TEST(test_a_normal_alarm_that_returns_stays_normal);
	RUN_TEST(test_a_normal_alarm_acknowledged_stays_normal);
	RUN_TEST(test_an_unacknowledged_alarm_raised_stays_unacknowledged);
	RUN_TEST(test_an_unacknowledged_alarm_that_returns_waits_to_be_acknowledged);
	RUN_TEST(test_an_unacknowledged_alarm_acknowledged_is_acknowledged);
	RUN_TEST(test_an_acknowledged_alarm_raised_is_unacknowledged_again);
	RUN_TEST(test_an_acknowledged_alarm_that_returns_is_normal);
	RUN_TEST(test_an_acknowledged_alarm_acknowledged_stays_so);
	RUN_TEST(test_a_returned_alarm_raised_is_unacknowledged);
	RUN_TEST(test_a_returned_alarm_that_returns_stays_returned);
	RUN_TEST(test_a_returned_alarm_acknowledged_is_normal);
	RUN_TEST(test_each_limit_raises_its_kind);
	RUN_TEST(test_a_limit_that_is_not_given_raises_nothing);
	RUN_TEST(test_an_alarm_is_raised_once);
	RUN_TEST(test_the_whole_life_of_an_alarm);
	RUN_TEST(test_a_returned_alarm_keeps_its_kind_until_it_is_acknowledged);
	RUN_TEST(test_from_high_to_high_high_it_is_unacknowledged_again);
	RUN_TEST(test_from_high_high_to_high_nothing_is_raised);
	RUN_TEST(test_from_high_to_low_it_is_raised_anew);
	RUN_TEST(test_hysteresis_holds_an_alarm_but_does_not_raise_it);
	RUN_TEST(test_an_alarm_is_raised_after_its_on_delay);
	RUN_TEST(test_an_on_delay_begins_anew_when_the_value_was_inside);
	RUN_TEST(test_on_the_way_up_each_limit_has_its_own_delay);
	RUN_TEST(test_an_alarm_returns_after_its_off_delay);
	RUN_TEST(test_a_bad_value_is_an_alarm_of_its_own);
	RUN_TEST(test_a_stale_value_is_an_alarm_of_its_own);
	RUN_TEST(test_a_value_never_read_is_no_alarm);
	RUN_TEST(test_an_alarm_of_the_value_stands_while_the_value_is_not_known);
	RUN_TEST(test_no_delay_of_the_value_runs_while_it_is_not_known);
	RUN_TEST(test_a_kind_of_high_rank_hides_one_that_is_raised_under_it);
	RUN_TEST(test_from_each_state_shelving_leads_to_no_alarm_that_is_shown);
	RUN_TEST(test_from_each_state_an_alarm_that_is_unshelved_is_raised_if_it_stands);
	RUN_TEST(test_a_shelved_alarm_is_neither_raised_nor_returned);
	RUN_TEST(test_a_shelved_alarm_cannot_be_acknowledged);
	RUN_TEST(test_delays_run_while_an_alarm_is_shelved);
	RUN_TEST(test_what_is_not_shelved_stays_as_it_is_when_it_is_unshelved);
	RUN_TEST(test_the_state_fits_the_conditions_whatever_comes);
	return UNITY_END();
}
