/* SPDX-License-Identifier: MIT */
/*
 * No trouble, no restart and no noise makes a MAX31888 say what is not true, nor a chip behind
 * branches, nor lets a write reach the chip of another branch.
 */
#include "tests/unit/aid/visit_group.h"

static const struct visit writes[] = {
	{0},
};

VISIT_GROUP(VISIT_BRIDGES)

static const struct visit writes_behind[] = {
	{.chip = "DS2433", .property = "pages/page.3", .write = "and how it is behind"},
	{.chip = "DS2413", .property = "PIO.BYTE", .write = "2"},
	{0},
};

static void test_no_trouble_makes_a_chip_behind_branches_say_what_is_not_true(void)
{
	visit_behind = true;
	visit_truth("DS18B20", false);
	visit_writes("DS2433", false, writes_behind);
	visit_writes("DS2413", false, writes_behind);
	visit_behind = false;
}

int main(void)
{
	UNITY_BEGIN();
	VISIT_RUN(VISIT_BRIDGES)
	RUN_TEST(test_no_trouble_makes_a_chip_behind_branches_say_what_is_not_true);
	return UNITY_END();
}
