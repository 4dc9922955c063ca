/* SPDX-License-Identifier: MIT */
/*
 * The visits of a group of chips, as a program: of each chip of the list (visit.h) every property
 * is read with each trouble of the wire and each loss of power, and what `writes` has of the chip
 * is written. The rows of `writes` end with {0}. A chip that has no row there has nothing to write;
 * one that is fed by the wire has those with .parasite.
 *
 *	VISIT_GROUP(VISIT_MEMORIES)
 *
 *	int main(void)
 *	{
 *		UNITY_BEGIN();
 *		VISIT_RUN(VISIT_MEMORIES)
 *		return UNITY_END();
 *	}
 */
#pragma once

#include "tests/unit/aid/visit_brownout.h"
#include "tests/unit/aid/visit_noise.h"
#include "tests/unit/aid/visit_truth.h"
#include "tests/unit/aid/visit_writes.h"
#include "unity.h"

/* clang-format off */
#define VISIT_TESTS(name, chip, parasite) \
	static void test_no_trouble_makes_a_##name##_say_what_is_not_true(void) \
	{ \
		visit_truth(chip, parasite); \
	} \
	static void test_no_restart_makes_a_##name##_give_what_is_not_true(void) \
	{ \
		visit_brownout(chip, parasite); \
	} \
	static void test_what_is_told_to_be_written_is_in_the_##name(void) \
	{ \
		visit_writes(chip, parasite, writes); \
	}
#define VISIT_NAME(name, chip, parasite) chip,
#define VISIT_GROUP(chips) \
	void setUp(void) \
	{ \
	} \
	void tearDown(void) \
	{ \
		if (bus) \
			visit_end(); \
	} \
	chips(VISIT_TESTS) \
	static void test_noise_makes_no_false_value_good(void) \
	{ \
		static const char *const names[] = {chips(VISIT_NAME) NULL}; \
		visit_noise(names); \
	}
#define VISIT_RUN_ONE(name, chip, parasite) \
	RUN_TEST(test_no_trouble_makes_a_##name##_say_what_is_not_true); \
	RUN_TEST(test_no_restart_makes_a_##name##_give_what_is_not_true); \
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_##name);
#define VISIT_RUN(chips) chips(VISIT_RUN_ONE) RUN_TEST(test_noise_makes_no_false_value_good);
/* clang-format on */
