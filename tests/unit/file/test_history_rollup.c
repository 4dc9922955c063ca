/* SPDX-License-Identifier: MIT */
/* Tests of roll-ups: those that are given out are what each signal had in their time. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "unity.h"

#include "src/history/file/rolling.h"
#include "src/history/file/schema.h"
#include "tests/unit/aid/past.h"

#define SIGNALS 5
#define STEPS 3000
#define BEGIN (1000 * HOUR_US)

struct step {
	int64_t id;
	uint32_t signal; /* 0: a gap of all */
	struct rollup_state state;
};
static struct step steps[STEPS];
static int count, minutes, hours;
static int64_t last_minute, last_hour;
static uint32_t last_signal[2];

static bool concerns(const struct step *step, uint32_t signal)
{
	return step->signal == signal || step->signal == 0;
}

/* What a signal had, step by step. */
static struct rollup brute(uint32_t signal, int64_t begin, int64_t end, struct rollup_state *state,
                           int *changes)
{
	struct rollup sum = {0};
	int64_t at = begin;

	*state = (struct rollup_state){0};
	*changes = 0;
	for (int i = 0; i < count && steps[i].id < end; i++) {
		if (!concerns(&steps[i], signal))
			continue;
		if (steps[i].id >= begin) {
			rollup_hold(&sum, state, steps[i].id - at);
			at = steps[i].id;
			*changes += steps[i].state.known || state->known;
		}
		*state = steps[i].state;
		if (steps[i].id >= begin && state->known)
			rollup_value(&sum, state);
	}
	rollup_hold(&sum, state, end - at);
	return sum;
}

static int check(void *ctx, bool hour, int64_t bucket, uint32_t signal, const struct rollup *sum,
                 const struct rollup_state *state)
{
	int64_t length = hour ? HOUR_US : MINUTE_US, *last = hour ? &last_hour : &last_minute;
	struct rollup_state end;
	int changes;
	struct rollup expected = brute(signal, bucket * length, (bucket + 1) * length, &end,
	                               &changes);

	(void)ctx;
	/* each once, in their order */
	TEST_ASSERT_TRUE(bucket > *last || (bucket == *last && signal > last_signal[hour]));
	*last = bucket;
	last_signal[hour] = signal;
	TEST_ASSERT_TRUE(hour || changes > 0);
	TEST_ASSERT_EQUAL_INT64(expected.known_us, sum->known_us);
	TEST_ASSERT_EQUAL_INT64(expected.good_us, sum->good_us);
	TEST_ASSERT_EQUAL_UINT32(expected.count, sum->count);
	TEST_ASSERT_EQUAL_INT(expected.has_value, sum->has_value);
	if (sum->has_value) {
		TEST_ASSERT_EQUAL_DOUBLE(expected.least, sum->least);
		TEST_ASSERT_EQUAL_DOUBLE(expected.most, sum->most);
		TEST_ASSERT_EQUAL_DOUBLE(expected.last, sum->last);
		TEST_ASSERT_DOUBLE_WITHIN(1e-6, rollup_mean(&expected), rollup_mean(sum));
		TEST_ASSERT_TRUE(rollup_mean(sum) >= sum->least - 1e-9 &&
		                 rollup_mean(sum) <= sum->most + 1e-9);
	}
	TEST_ASSERT_EQUAL_UINT8(expected.worst, sum->worst);
	TEST_ASSERT_EQUAL_INT(end.known, state->known);
	TEST_ASSERT_EQUAL_UINT8(end.quality, state->quality);
	minutes += !hour;
	hours += hour;
	return 0;
}

void setUp(void)
{
	count = minutes = hours = 0;
	last_minute = last_hour = 0;
	memset(last_signal, 0, sizeof(last_signal));
}

void tearDown(void)
{
}

/* Steps seconds apart, now and then hours. */
static void make_steps(void)
{
	int64_t id = BEGIN + 17;

	for (count = 0; count < STEPS; count++) {
		struct step *step = &steps[count];

		id += past_random(60) ? 1 + past_random(20000000) : past_random(3) * HOUR_US;
		*step = (struct step){.id = ++id, .signal = 1 + past_random(SIGNALS)};
		step->state.known = past_random(10) != 0;
		if (!step->state.known && past_random(2))
			step->signal = 0;
		if (step->state.known) {
			step->state.quality = past_random(8) ? OWS_Q_GOOD : OWS_Q_DEVICE;
			step->state.value = past_random(30) ? (double)past_random(1000) / 8 : NAN;
		}
	}
}

static int expected_minutes(void)
{
	int found = 0;

	for (uint32_t signal = 1; signal <= SIGNALS; signal++) {
		int64_t last = -1;
		bool known = false;

		for (int i = 0; i < count; i++) {
			if (!concerns(&steps[i], signal))
				continue;
			if ((steps[i].state.known || known) && steps[i].id / MINUTE_US != last) {
				last = steps[i].id / MINUTE_US;
				found++;
			}
			known = steps[i].state.known;
		}
	}
	return found;
}

static void test_minutes_and_hours_are_what_the_signals_had(void)
{
	struct rolling rolling = {.give = check};

	make_steps();
	rolling_begin(&rolling, BEGIN);
	for (int i = 0; i < count; i++) {
		const struct step *step = &steps[i];

		TEST_ASSERT_EQUAL_INT(
			0, step->state.known
				   ? rolling_value(&rolling, step->id, step->signal, &step->state)
				   : rolling_gap(&rolling, step->id, step->signal));
	}
	TEST_ASSERT_EQUAL_INT(0, rolling_advance(&rolling, steps[count - 1].id + 2 * HOUR_US));
	TEST_ASSERT_EQUAL_INT(expected_minutes(), minutes);
	TEST_ASSERT_TRUE(hours > 100);
	rolling_free(&rolling);
}

static void test_an_hour_in_which_nothing_is_known_has_no_row_and_years_of_them_cost_nothing(void)
{
	struct rolling rolling = {.give = check};
	struct rollup_state state = {.value = 1, .quality = OWS_Q_GOOD, .known = true};

	count = 2;
	steps[0] = (struct step){BEGIN + 5, 3, state};
	steps[1] = (struct step){BEGIN + 9, 0, {0}};
	rolling_begin(&rolling, BEGIN);
	rolling_value(&rolling, BEGIN + 5, 3, &state);
	rolling_gap(&rolling, BEGIN + 9, 0);
	TEST_ASSERT_FALSE(rolling_is_due(&rolling, BEGIN + MINUTE_US));
	TEST_ASSERT_TRUE(rolling_is_due(&rolling, BEGIN + HOUR_US));
	TEST_ASSERT_EQUAL_INT(0, rolling_advance(&rolling, BEGIN + INT64_C(1000000) * HOUR_US));
	TEST_ASSERT_EQUAL_INT(1, minutes);
	TEST_ASSERT_EQUAL_INT(1, hours);
	TEST_ASSERT_FALSE(rolling_is_due(&rolling, BEGIN + INT64_C(2000000) * HOUR_US));
	TEST_ASSERT_EQUAL_INT(-E2BIG, rolling_value(&rolling, BEGIN, HISTORY_SIGNALS + 1, &state));
	rolling_free(&rolling);
}

static void test_sums_join_as_if_they_were_one(void)
{
	struct rollup_state a = {3, OWS_Q_GOOD, true}, b = {5, OWS_Q_DEVICE, true}, none = {0};
	struct rollup one = {0}, left = {0}, right = {0};

	rollup_value(&one, &a), rollup_hold(&one, &a, 10);
	rollup_value(&left, &a), rollup_hold(&left, &a, 10);
	rollup_value(&one, &b), rollup_hold(&one, &b, 20), rollup_hold(&one, &none, 5);
	rollup_value(&right, &b), rollup_hold(&right, &b, 20), rollup_hold(&right, &none, 5);
	rollup_add(&left, &right);
	TEST_ASSERT_EQUAL_MEMORY(&one, &left, sizeof(one));
	TEST_ASSERT_EQUAL_INT64(30, left.known_us);
	TEST_ASSERT_EQUAL_INT64(10, left.good_us);
	TEST_ASSERT_EQUAL_DOUBLE(3, rollup_mean(&left));
	TEST_ASSERT_EQUAL_UINT8(OWS_Q_DEVICE, left.worst);
	TEST_ASSERT_TRUE(isnan(rollup_mean(&(struct rollup){0})));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_minutes_and_hours_are_what_the_signals_had);
	RUN_TEST(test_an_hour_in_which_nothing_is_known_has_no_row_and_years_of_them_cost_nothing);
	RUN_TEST(test_sums_join_as_if_they_were_one);
	return UNITY_END();
}
