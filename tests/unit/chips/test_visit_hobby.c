/* SPDX-License-Identifier: MIT */
/* No trouble, no restart and no noise makes a device of another maker say what is not true. */
#include "tests/unit/aid/visit_group.h"

static const struct visit writes[] = {
	{.chip = "LCD", .property = "memory", .write = "some bytes", .stride = 3},
	{.chip = "HB_UVI_METER", .property = "UVI/UVI_offset", .write = "-2.5"},
	{.chip = "HB_UVI_METER", .property = "temperature_offset", .write = "-2.5"},
	{.chip = "HB_UVI_METER", .property = "UVI/in_case", .write = "0"},
	{.chip = "HB_MOISTURE_METER", .property = "moisture/is_leaf.2", .write = "0"},
	{.chip = "HB_MOISTURE_METER", .property = "moisture/calibrate/max", .write = "4000"},
	{.chip = "HB_BAROMETER", .property = "barometer/altitude", .write = "-300"},
	{.chip = "HB_BAROMETER", .property = "barometer/location", .write = "on the roof"},
	{.chip = "HB_HUMIDITY", .property = "humidity/humidity_offset", .write = "-2.5"},
	{.chip = "HB_MULTITEMP", .property = "multitemp/polling_frequency", .write = "4"},
	{0},
};

VISIT_GROUP(VISIT_HOBBY)

int main(void)
{
	UNITY_BEGIN();
	VISIT_RUN(VISIT_HOBBY)
	return UNITY_END();
}
