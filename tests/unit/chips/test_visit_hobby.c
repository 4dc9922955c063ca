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
	{.chip = "BAE0910", .property = "910/usera", .write = "77"},
	{.chip = "BAE0910", .property = "910/userm", .write = "305419896"},
	{.chip = "BAE0910", .property = "910/duty1", .write = "1234"},
	{.chip = "BAE0910", .property = "910/outc", .write = "16"},
	{.chip = "BAE0911", .property = "911/pio/pio.3", .write = "1"},
	{.chip = "BAE0911", .property = "911/pio/direction.3", .write = "1"},
	{.chip = "BAE0911", .property = "911/pwm1/duty_ch0", .write = "1234"},
	{.chip = "BAE0911", .property = "911/user_registers/dword.2", .write = "305419896"},
	{.chip = "BAE0911", .property = "911/automation_engine/global_mem.3", .write = "77"},
	{.chip = "IE_RGBW", .property = "rgbw_channel1", .write = "10,20,30,40,0"},
	{.chip = "IE_SWITCH_MASTER", .property = "relay_port0", .write = "1,0,1"},
	{.chip = "IE_SWITCH_MASTER", .property = "relay_mode0", .write = "2,1"},
	{.chip = "IE_SWITCH_MASTER", .property = "relay_timeout0", .write = "20,30,40,50"},
	{.chip = "IE_SWITCH_MASTER", .property = "led_port1", .write = "1,0,1"},
	{.chip = "IE_SWITCH_MASTER", .property = "set_switch_type", .write = "1,2,3"},
	{0},
};

VISIT_GROUP(VISIT_HOBBY)

int main(void)
{
	UNITY_BEGIN();
	VISIT_RUN(VISIT_HOBBY)
	return UNITY_END();
}
