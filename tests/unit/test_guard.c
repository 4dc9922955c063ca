/* SPDX-License-Identifier: MIT */
#include "src/engine/guard.h"

#include "unity.h"

#define S 1000000000LL

void setUp(void) {}
void tearDown(void) {}

static void test_temperatures_of_thermometers_are_watched_in_every_spelling(void)
{
	static const char *const yes[] = {
		"/28.551DDF030000/temperature12", "/28551ddf030000/temperature",
		"/10.E466DA610B63/temperature",   "/22.000000000000/fasttemp",
		"/3b.112233445566/latesttemp",    "/42.112233445566/temperature9",
		"/bus.1/28.551DDF030000/temperature10", "/boiler/temperature",
		"/1F.112233445566/main/28.551DDF030000/temperature",
	};
	static const char *const no[] = {
		"/28.551DDF030000/templow",  "/28.551DDF030000/power", "/26.0CBEEA010000/temperature",
		"/simultaneous/temperature", "/29.B89115000000/sensed.BYTE",
		"/26.0CBEEA010000/humidity", "/",
	};

	for (unsigned i = 0; i < sizeof(yes) / sizeof(yes[0]); i++)
		TEST_ASSERT_TRUE_MESSAGE(guard_watches(yes[i]), yes[i]);
	for (unsigned i = 0; i < sizeof(no) / sizeof(no[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(guard_watches(no[i]), no[i]);
}

static void test_85_out_of_nothing_is_refused(void)
{
	struct guard guard = { 0 };

	TEST_ASSERT_TRUE(guard_refuses(&guard, 85.0, S));
}

static void test_85_after_room_temperature_is_refused(void)
{
	struct guard guard = { 0 };

	TEST_ASSERT_FALSE(guard_refuses(&guard, 21.5, S));
	TEST_ASSERT_TRUE(guard_refuses(&guard, 85.0, 2 * S));
}

static void test_a_boiler_may_pass_85(void)
{
	struct guard guard = { 0 };

	TEST_ASSERT_FALSE(guard_refuses(&guard, 83.0625, S));
	TEST_ASSERT_FALSE(guard_refuses(&guard, 84.9375, 2 * S));
	TEST_ASSERT_FALSE(guard_refuses(&guard, 85.0, 3 * S));
	TEST_ASSERT_FALSE(guard_refuses(&guard, 85.0625, 4 * S));
}

static void test_an_old_reading_near_85_does_not_vouch_for_85(void)
{
	struct guard guard = { 0 };

	TEST_ASSERT_FALSE(guard_refuses(&guard, 84.0, S));
	TEST_ASSERT_TRUE(guard_refuses(&guard, 85.0, 100 * S));
}

static void test_a_refused_reading_does_not_vouch_for_the_next(void)
{
	struct guard guard = { 0 };

	for (int i = 1; i < 10; i++)
		TEST_ASSERT_TRUE(guard_refuses(&guard, 85.0, i * S));
}

static void test_127_94_is_refused_always_also_as_owserver_prints_it(void)
{
	struct guard guard = { 0 };

	TEST_ASSERT_FALSE(guard_refuses(&guard, 125.0, S));
	TEST_ASSERT_TRUE(guard_refuses(&guard, 127.9375, 2 * S));
	TEST_ASSERT_TRUE(guard_refuses(&guard, 127.938, 3 * S));
}

static void test_neighbours_of_85_are_believed(void)
{
	struct guard guard = { 0 };

	TEST_ASSERT_FALSE(guard_refuses(&guard, 84.9375, S));
	guard = (struct guard){ 0 };
	TEST_ASSERT_FALSE(guard_refuses(&guard, 85.0625, S));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_temperatures_of_thermometers_are_watched_in_every_spelling);
	RUN_TEST(test_85_out_of_nothing_is_refused);
	RUN_TEST(test_85_after_room_temperature_is_refused);
	RUN_TEST(test_a_boiler_may_pass_85);
	RUN_TEST(test_an_old_reading_near_85_does_not_vouch_for_85);
	RUN_TEST(test_a_refused_reading_does_not_vouch_for_the_next);
	RUN_TEST(test_127_94_is_refused_always_also_as_owserver_prints_it);
	RUN_TEST(test_neighbours_of_85_are_believed);
	return UNITY_END();
}
