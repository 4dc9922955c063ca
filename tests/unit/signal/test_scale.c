/* SPDX-License-Identifier: MIT */
/* Tests of scaling in both directions: by examples, and by properties of random scales. */
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/ground/signal/scale.h"
#include "src/public/ows.h"

#define COUNT(a) (sizeof(a) / sizeof((a)[0]))
#define ROUNDS 2000

static const uint64_t seed = 0x5ca1ab1eu;
static uint64_t state;

void setUp(void)
{
	state = seed;
}

void tearDown(void)
{
}

static uint64_t next_random(void)
{
	state ^= state << 13;
	state ^= state >> 7;
	state ^= state << 17;
	return state;
}

/* From least to most. */
static double random_between(double least, double most)
{
	return least + (double)(next_random() >> 11) * 0x1p-53 * (most - least);
}

/* Of any sign and of sizes from 1e-6 to 1e6; never 0. */
static double random_number(void)
{
	double size = pow(10, random_between(-6, 6));

	return next_random() & 1 ? size : -size;
}

static double value_of(const struct scale *scale, double raw)
{
	uint8_t quality;

	return scale_value(scale, raw, &quality);
}

static uint8_t quality_of(const struct scale *scale, double raw)
{
	uint8_t quality;

	scale_value(scale, raw, &quality);
	return quality;
}

static double raw_of(const struct scale *scale, double value)
{
	double raw = NAN;

	TEST_ASSERT_EQUAL_INT(0, scale_raw(scale, value, &raw));
	return raw;
}

static void random_points(struct scale *scale, struct scale_point points[SCALE_POINTS_MAX])
{
	double raw = random_number(), value = random_number();
	double way = next_random() & 1 ? 1 : -1;
	unsigned count = 2 + (unsigned)(next_random() % (SCALE_POINTS_MAX - 1));

	for (unsigned i = 0; i < count; i++) {
		points[i] = (struct scale_point){raw, value};
		raw += fabs(random_number()) + fabs(raw) * 1e-9;
		value += way * (fabs(random_number()) + fabs(value) * 1e-9);
	}
	*scale = (struct scale){.points = points, .count = count};
}

/* Equal to the last bit; Unity's comparison of doubles is not. */
static void expect_same(double expected, double found)
{
	TEST_ASSERT_TRUE(expected == found);
}

/* A value and what one unit of the last place of the numbers that it was made of can change. */
static void expect_near(double expected, double found, double noise)
{
	TEST_ASSERT_TRUE_MESSAGE(isfinite(found), "not finite");
	TEST_ASSERT_DOUBLE_WITHIN(noise, expected, found);
}

static void test_nothing_given_changes_nothing(void)
{
	static const double numbers[] = {0, 1, -4.7, 0.1, 1e300, -DBL_MAX, DBL_MIN};
	const struct scale none = {0};

	TEST_ASSERT_FALSE(scale_changes(&none));
	for (size_t i = 0; i < COUNT(numbers); i++) {
		expect_same(numbers[i], value_of(&none, numbers[i]));
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality_of(&none, numbers[i]));
		expect_same(numbers[i], raw_of(&none, numbers[i]));
	}
}

static void test_a_transmitter_of_4_to_20_mA_is_scaled_both_ways(void)
{
	const struct scale by_factor = {.linear = true, .factor = 6.25, .offset = -25};
	struct scale_point points[SCALE_POINTS_MAX];
	struct scale by_points = {.points = points, .count = 2};
	static const double pairs[][2] = {{4, 0}, {12, 50}, {20, 100}, {8, 25}};

	TEST_ASSERT_EQUAL_INT(2, scale_parse("4:0 20:100", points));
	for (size_t i = 0; i < COUNT(pairs); i++) {
		expect_same(pairs[i][1], value_of(&by_factor, pairs[i][0]));
		expect_same(pairs[i][1], value_of(&by_points, pairs[i][0]));
		expect_same(pairs[i][0], raw_of(&by_factor, pairs[i][1]));
		expect_same(pairs[i][0], raw_of(&by_points, pairs[i][1]));
	}
}

static void test_points_hold_at_their_ends_with_quality_out_of_range(void)
{
	struct scale_point points[SCALE_POINTS_MAX];
	struct scale scale = {.points = points, .count = 3};
	double raw = 77;

	TEST_ASSERT_EQUAL_INT(3, scale_parse("0:10 1:20 3:50", points));
	expect_same(10, value_of(&scale, -5));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_LOW, quality_of(&scale, -5));
	expect_same(50, value_of(&scale, 3.001));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_HIGH, quality_of(&scale, 3.001));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality_of(&scale, 0));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality_of(&scale, 3));
	TEST_ASSERT_EQUAL_INT(-ERANGE, scale_raw(&scale, 9.999, &raw));
	TEST_ASSERT_EQUAL_INT(-ERANGE, scale_raw(&scale, 50.001, &raw));
	expect_same(77, raw);
}

static void test_the_low_end_of_falling_points_is_their_last(void)
{
	struct scale_point points[SCALE_POINTS_MAX];
	struct scale scale = {.points = points, .count = 2};

	TEST_ASSERT_EQUAL_INT(2, scale_parse("0:100 10:0", points));
	TEST_ASSERT_EQUAL_DOUBLE(0, value_of(&scale, 11));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_LOW, quality_of(&scale, 11));
	TEST_ASSERT_EQUAL_DOUBLE(100, value_of(&scale, -1));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_HIGH, quality_of(&scale, -1));
}

static void test_a_range_continues_the_points_as_far_as_it_goes(void)
{
	struct scale_point points[SCALE_POINTS_MAX];
	struct scale scale = {.points = points,
	                      .count = 2,
	                      .has_min = true,
	                      .min = -2.5,
	                      .has_max = true,
	                      .max = 102.5};
	double raw;

	TEST_ASSERT_EQUAL_INT(2, scale_parse("4:0 20:100", points));
	TEST_ASSERT_EQUAL_DOUBLE(-1.25, value_of(&scale, 3.8));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality_of(&scale, 3.8));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality_of(&scale, 3.6));
	TEST_ASSERT_EQUAL_DOUBLE(-25, value_of(&scale, 0));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_RANGE, quality_of(&scale, 0));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_RANGE, quality_of(&scale, 20.5));
	TEST_ASSERT_EQUAL_DOUBLE(3.6, raw_of(&scale, -2.5));
	TEST_ASSERT_EQUAL_INT(-ERANGE, scale_raw(&scale, 102.6, &raw));
	/* the other end has no range: it holds */
	scale.has_max = false;
	TEST_ASSERT_EQUAL_DOUBLE(100, value_of(&scale, 21));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_HIGH, quality_of(&scale, 21));
}

static void test_a_range_inside_the_points_cuts_them(void)
{
	struct scale_point points[SCALE_POINTS_MAX];
	struct scale scale = {.points = points, .count = 2, .has_max = true, .max = 80};
	double raw;

	TEST_ASSERT_EQUAL_INT(2, scale_parse("4:0 20:100", points));
	TEST_ASSERT_EQUAL_DOUBLE(90, value_of(&scale, 18.4));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_RANGE, quality_of(&scale, 18.4));
	TEST_ASSERT_EQUAL_INT(-ERANGE, scale_raw(&scale, 81, &raw));
}

static void test_a_range_judges_values_that_are_not_scaled(void)
{
	struct scale scale = {.has_min = true, .min = 0, .has_max = true, .max = 10};
	double raw;

	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality_of(&scale, 0));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality_of(&scale, 10));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_RANGE, quality_of(&scale, -1e-12));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_RANGE, quality_of(&scale, nextafter(10, 11)));
	TEST_ASSERT_EQUAL_DOUBLE(11, value_of(&scale, 11));
	TEST_ASSERT_EQUAL_INT(-ERANGE, scale_raw(&scale, -1, &raw));
	TEST_ASSERT_EQUAL_DOUBLE(7, raw_of(&scale, 7));
}

static void test_rounding_puts_no_end_of_a_scale_out_of_its_range(void)
{
	for (int i = 0; i < ROUNDS; i++) {
		double low = random_number(), high = low + fabs(random_number()) + 1e-3;
		struct scale scale = {.linear = true, .has_min = true, .has_max = true};

		/* as a user computes the two from "low is 0 %, high is 100 %" */
		scale.factor = 100 / (high - low);
		scale.offset = -low * scale.factor;
		scale.max = 100;
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality_of(&scale, low));
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality_of(&scale, high));
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_RANGE, quality_of(&scale, low - (high - low) / 1000));
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_RANGE, quality_of(&scale, high + (high - low) / 1000));
	}
}

static void test_the_inverse_of_a_factor_gives_the_raw_value_back(void)
{
	for (int i = 0; i < ROUNDS; i++) {
		struct scale scale = {
			.linear = true, .factor = random_number(), .offset = random_number()};
		double raw = random_number(), value = value_of(&scale, raw);
		double noise = 4 * DBL_EPSILON * (fabs(value) + fabs(scale.offset));

		expect_near(raw, raw_of(&scale, value), noise / fabs(scale.factor));
		expect_near(value, value_of(&scale, raw_of(&scale, value)), noise);
	}
}

static void test_points_are_exact_in_both_directions(void)
{
	struct scale_point points[SCALE_POINTS_MAX];
	struct scale scale;

	for (int i = 0; i < ROUNDS; i++) {
		random_points(&scale, points);
		for (unsigned k = 0; k < scale.count; k++) {
			expect_same(points[k].value, value_of(&scale, points[k].raw));
			expect_same(points[k].raw, raw_of(&scale, points[k].value));
			TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality_of(&scale, points[k].raw));
		}
	}
}

static void test_the_inverse_of_points_gives_the_value_back(void)
{
	struct scale_point points[SCALE_POINTS_MAX];
	struct scale scale;

	for (int i = 0; i < ROUNDS; i++) {
		const struct scale_point *a, *b;
		double raw, value, slope, noise;

		random_points(&scale, points);
		a = &points[next_random() % (scale.count - 1)];
		b = a + 1;
		raw = random_between(a->raw, b->raw);
		value = value_of(&scale, raw);
		slope = fabs((b->value - a->value) / (b->raw - a->raw));
		/* what rounding of raw means in the value, and rounding of the value itself */
		noise = 4 * DBL_EPSILON *
		        ((fabs(a->raw) + fabs(b->raw)) * slope + fabs(a->value) + fabs(b->value));
		expect_near(value, value_of(&scale, raw_of(&scale, value)), noise);
	}
}

static void test_a_line_through_points_rises_or_falls_throughout(void)
{
	struct scale_point points[SCALE_POINTS_MAX];
	struct scale scale;

	for (int i = 0; i < ROUNDS / 10; i++) {
		double way, raw, before;

		random_points(&scale, points);
		way = points[1].value > points[0].value ? 1 : -1;
		raw = points[0].raw - 1;
		before = value_of(&scale, raw);
		for (int k = 0; k < 500; k++) {
			const struct scale_point *p = &points[next_random() % scale.count];
			double next = k % 2 ? random_between(raw, points[scale.count - 1].raw + 1)
			                    : fmax(nextafter(p->raw, -DBL_MAX), raw);
			double value = value_of(&scale, next);

			TEST_ASSERT_TRUE(way * (value - before) >= 0);
			raw = next;
			before = value;
		}
	}
}

static void test_huge_numbers_are_held_and_never_nan(void)
{
	static const double huge[] = {DBL_MAX, -DBL_MAX, 1e308, -1e308, 1e200, 0, DBL_MIN};
	struct scale_point points[] = {{0, 0}, {1e-300, 1e300}};
	struct scale scale = {.points = points,
	                      .count = 2,
	                      .has_min = true,
	                      .min = -DBL_MAX,
	                      .has_max = true,
	                      .max = DBL_MAX};

	for (size_t i = 0; i < COUNT(huge); i++) {
		TEST_ASSERT_TRUE(isfinite(value_of(&scale, huge[i])));
		for (size_t k = 0; k < COUNT(huge); k++) {
			struct scale linear = {
				.linear = true, .factor = huge[k] + 1, .offset = -huge[i]};
			double raw = 0;

			TEST_ASSERT_TRUE(isfinite(value_of(&linear, huge[i])));
			TEST_ASSERT_TRUE(!scale_raw(&linear, huge[i], &raw) ? isfinite(raw)
			                                                    : raw == 0);
		}
	}
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_HIGH, quality_of(&scale, 1e200));
}

static void test_two_scales_are_the_same_if_they_scale_the_same(void)
{
	struct scale_point points[] = {{0, 0}, {1, 2}}, others[] = {{0, 0}, {1, 3}}, copy[2];
	struct scale a = {.points = points, .count = 2}, b = a;

	memcpy(copy, points, sizeof(copy));
	b.points = copy;
	TEST_ASSERT_TRUE(scale_same(&a, &b));
	b.points = others;
	TEST_ASSERT_FALSE(scale_same(&a, &b));
	b = a;
	b.has_max = true;
	TEST_ASSERT_FALSE(scale_same(&a, &b));
	a = (struct scale){.linear = true, .factor = 2};
	b = a;
	TEST_ASSERT_TRUE(scale_same(&a, &b));
	b.offset = 1;
	TEST_ASSERT_FALSE(scale_same(&a, &b));
}

static void test_points_that_are_none_are_refused(void)
{
	static const struct {
		const char *text;
		int err;
	} cases[] = {
		{"", -EDOM},
		{"4:0", -EDOM},
		{"4:0 20", -EILSEQ},
		{"4:0 20:", -EILSEQ},
		{"4:0 :100", -EILSEQ},
		{"4:0,20:100", -EILSEQ},
		{"4:0 4:1", -EINVAL},
		{"20:0 4:100", -EINVAL},
		{"0:0 1:1 2:1", -ERANGE},
		{"0:0 1:nan", -EILSEQ},
		{"0:0 1:1 2:0", -ERANGE},
		{"0:0 1:1e999", -EILSEQ},
		{"0:0 1:0x10", -EILSEQ},
		{"-1e308:0 1e308:1", -EINVAL},
		{"0:-1e308 1:1e308", -ERANGE},
	};
	struct scale_point points[SCALE_POINTS_MAX];
	char many[400] = "";

	for (size_t i = 0; i < COUNT(cases); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].err, scale_parse(cases[i].text, points),
		                              cases[i].text);
	for (int i = 0; i < SCALE_POINTS_MAX; i++)
		snprintf(many + strlen(many), sizeof(many) - strlen(many), " %d:%d", i, -i);
	TEST_ASSERT_EQUAL_INT(SCALE_POINTS_MAX, scale_parse(many, points));
	TEST_ASSERT_EQUAL_DOUBLE(-31, points[31].value);
	strcat(many, " 99:-99");
	TEST_ASSERT_EQUAL_INT(-E2BIG, scale_parse(many, points));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_nothing_given_changes_nothing);
	RUN_TEST(test_a_transmitter_of_4_to_20_mA_is_scaled_both_ways);
	RUN_TEST(test_points_hold_at_their_ends_with_quality_out_of_range);
	RUN_TEST(test_the_low_end_of_falling_points_is_their_last);
	RUN_TEST(test_a_range_continues_the_points_as_far_as_it_goes);
	RUN_TEST(test_a_range_inside_the_points_cuts_them);
	RUN_TEST(test_a_range_judges_values_that_are_not_scaled);
	RUN_TEST(test_rounding_puts_no_end_of_a_scale_out_of_its_range);
	RUN_TEST(test_the_inverse_of_a_factor_gives_the_raw_value_back);
	RUN_TEST(test_points_are_exact_in_both_directions);
	RUN_TEST(test_the_inverse_of_points_gives_the_value_back);
	RUN_TEST(test_a_line_through_points_rises_or_falls_throughout);
	RUN_TEST(test_huge_numbers_are_held_and_never_nan);
	RUN_TEST(test_two_scales_are_the_same_if_they_scale_the_same);
	RUN_TEST(test_points_that_are_none_are_refused);
	return UNITY_END();
}
