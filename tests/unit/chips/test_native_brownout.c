/* SPDX-License-Identifier: MIT */
/* No restart makes a false value of a thermometer or a switch good (visit_brownout.h). */
#include "unity.h"

#include "tests/unit/aid/visit_brownout.h"

void setUp(void)
{
}

void tearDown(void)
{
	if (bus)
		visit_end();
}

#define LOOKS(name, chip, parasite) \
	static void test_no_restart_makes_a_##name##_give_what_is_not_true(void) \
	{ \
		visit_brownout(chip, parasite); \
	}

VISIT_CHIPS(LOOKS)

#define RUN(name, chip, parasite) RUN_TEST(test_no_restart_makes_a_##name##_give_what_is_not_true);

int main(void)
{
	UNITY_BEGIN();
	VISIT_CHIPS(RUN)
	return UNITY_END();
}
