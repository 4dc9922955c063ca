/* SPDX-License-Identifier: MIT */
/* What a thermometer or a switch is told to be written is in it (visit_writes.h). */
#include "unity.h"

#include "tests/unit/aid/visit_writes.h"

void setUp(void)
{
}

void tearDown(void)
{
	if (bus)
		visit_end();
}

static const struct visit visits[] = {
	{.chip = "DS18B20", .property = "temphigh", .write = "33"},
	{.chip = "DS18B20", .property = "templow", .write = "-7", .parasite = true},
	{.chip = "DS18B20", .property = "tempres", .write = "10"},
	{.chip = "DS18S20", .property = "temphigh", .write = "33"},
	{.chip = "DS28EA00", .property = "latch.BYTE", .write = "1"},
	{.chip = "DS2405", .property = "PIO", .write = "1"},
	{.chip = "DS2405", .property = "PIO", .write = "0", .turned = true},
	{.chip = "DS2406", .property = "PIO.BYTE", .write = "2"},
	{.chip = "DS2406", .property = "PIO.A", .write = "1"},
	{.chip = "DS2406", .property = "set_alarm", .write = "121"},
	{.chip = "DS2406", .property = "latch.BYTE", .write = "0"},
	{.chip = "DS2408", .property = "PIO.BYTE", .write = "165"},
	{.chip = "DS2408", .property = "PIO.3", .write = "1"},
	{.chip = "DS2408", .property = "latch.BYTE", .write = "0"},
	{.chip = "DS2408", .property = "set_alarm", .write = "133333333"},
	{.chip = "DS2408", .property = "strobe", .write = "1"},
	{.chip = "DS2408", .property = "por", .write = "0"},
	{.chip = "DS2413", .property = "PIO.BYTE", .write = "2"},
	{.chip = "DS2450", .property = "PIO.B", .write = "0"},
	{.chip = "DS2450", .property = "set_alarm/high.C", .write = "0"},
	{.chip = "DS2450", .property = "set_alarm/unset", .write = "1"},
	{.chip = "DS2450", .property = "set_alarm/volthigh.D", .write = "3"},
	{.chip = "DS2450", .property = "power", .write = "1"},
	{.chip = "DS2450", .property = "pages/page.2", .write = "abcdefgh"},
	{0},
};

#define WRITES(name, chip) \
	static void test_what_is_told_to_be_written_is_in_the_##name(void) \
	{ \
		visit_writes(chip, visits); \
	}

WRITES(ds18b20, "DS18B20")
WRITES(ds18s20, "DS18S20")
WRITES(ds28ea00, "DS28EA00")
WRITES(ds2405, "DS2405")
WRITES(ds2406, "DS2406")
WRITES(ds2408, "DS2408")
WRITES(ds2413, "DS2413")
WRITES(ds2450, "DS2450")

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds18b20);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds18s20);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds28ea00);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2405);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2406);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2408);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2413);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2450);
	return UNITY_END();
}
