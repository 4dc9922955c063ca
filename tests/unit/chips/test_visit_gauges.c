/* SPDX-License-Identifier: MIT */
/* No trouble, no restart and no noise makes a battery gauge say what is not true. */
#include "tests/unit/aid/visit_group.h"

static const struct visit writes[] = {
	{.chip = "DS2751", .property = "PIO", .write = "1"},
	{.chip = "DS2751", .property = "vbias", .write = "0.001", .stride = 11},
	{.chip = "DS2755", .property = "alarm_set", .write = "33"},
	{.chip = "DS2755", .property = "pages/page.1", .write = "abcdefgh", .stride = 13},
	{.chip = "DS2760", .property = "ce", .write = "0"},
	{.chip = "DS2760", .property = "vbias", .write = "0.001", .stride = 11},
	{.chip = "DS2760", .property = "defaultpmod", .write = "0", .stride = 11},
	{.chip = "DS2770", .property = "timer", .write = "100"},
	{.chip = "DS2780", .property = "porf", .write = "0"},
	{.chip = "DS2780", .property = "uven", .write = "0", .stride = 11},
	{.chip = "DS2781", .property = "vis_offset", .write = "0.0001", .stride = 11},
	{.chip = "DS2781", .property = "volthours", .write = "0.1"},
	{0},
};

VISIT_GROUP(VISIT_GAUGES)

int main(void)
{
	UNITY_BEGIN();
	VISIT_RUN(VISIT_GAUGES)
	return UNITY_END();
}
