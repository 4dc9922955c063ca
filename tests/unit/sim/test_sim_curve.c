/* SPDX-License-Identifier: MIT */
/* The simulator's own sine and rounding, which spare the daemon libm, against libm. */
#include <math.h>

#include "unity.h"

#include "hal/sim/curve.h"

#define SPAN INT64_C(86400000000000)

void setUp(void)
{
}
void tearDown(void)
{
}

static double sine_at(int64_t t)
{
	const struct sim_curve curve = {.shape = SIM_SINE, .a = 0, .b = 1, .span_ns = SPAN};

	return sim_curve_at(&curve, t);
}

static void test_the_sine_is_that_of_libm(void)
{
	for (int i = -1000; i <= 3000; i++) {
		int64_t t = SPAN / 1000 * i + i;
		double expected = t < 0 ? 0 : sin(2 * acos(-1) * (double)(t % SPAN) / (double)SPAN);

		TEST_ASSERT_DOUBLE_WITHIN(1e-12, expected, sine_at(t));
	}
}

static void test_the_sine_is_exact_at_each_quarter(void)
{
	static const double quarters[] = {0, 1, 0, -1};

	for (int i = 0; i < 12; i++)
		TEST_ASSERT_EQUAL_DOUBLE(quarters[i % 4], sine_at(SPAN / 4 * i));
}

static void test_rounding_is_that_of_libm_and_defined_beyond_it(void)
{
	static const double values[] = {0, 0.25, 0.5, 1.5, 2.5, 124.96875, 1e9, 1e15, 4.5e15};

	for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
		TEST_ASSERT_EQUAL_INT64(llround(values[i]), sim_round(values[i]));
		TEST_ASSERT_EQUAL_INT64(llround(-values[i]), sim_round(-values[i]));
	}
	TEST_ASSERT_EQUAL_INT64(INT64_C(1) << 53, sim_round(1e300));
	TEST_ASSERT_EQUAL_INT64(-(INT64_C(1) << 53), sim_round(-INFINITY));
	TEST_ASSERT_EQUAL_INT64(0, sim_round(NAN));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_sine_is_that_of_libm);
	RUN_TEST(test_the_sine_is_exact_at_each_quarter);
	RUN_TEST(test_rounding_is_that_of_libm_and_defined_beyond_it);
	return UNITY_END();
}
