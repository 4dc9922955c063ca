/* SPDX-License-Identifier: MIT */
/* What the simulated DS2490 does on its wire, against the tables of its data sheet. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/usb_hand.h"

/* Its own chip, and others. */
static const char house[] = "chip DS2482-100 0x18\n"
			    "DS1420 81.000000000042 as own\n"
			    "DS18B20 28.0000000000E3 as t temperature 21.5\n"
			    "DS18B20 28.0000000000A2 as u temperature 30 parasite\n"
			    "DS2401 01.000000000001 as id\n";
void setUp(void)
{
	usb_begin(house);
}

void tearDown(void)
{
	usb_end();
}

static void test_a_reset_of_the_wire_says_what_it_met(void)
{
	usb_comm(DS2490_WIRE_RESET | DS2490_IM, 0);
	TEST_ASSERT_FALSE(usb_has(DS2490_IDLE));
	TEST_ASSERT_EQUAL_HEX8(DS2490_WIRE_RESET | DS2490_IM, usb.state[DS2490_AT_COMMAND]);
	TEST_ASSERT_EQUAL_INT64(1096 * USB_US, usb_finish());
	TEST_ASSERT_EQUAL_INT(0, usb_look()); /* no error, and not asked to tell */
	TEST_ASSERT_EQUAL_HEX8(0, usb.state[DS2490_AT_COMMAND]);
	TEST_ASSERT_EQUAL_HEX8(0, usb_result_of(DS2490_WIRE_RESET, 0));
	usb_event("short 0x18");
	TEST_ASSERT_EQUAL_HEX8(DS2490_SH, usb_result_of(DS2490_WIRE_RESET, 0));
	usb_event("end short 0x18");
	usb_event("unplug own");
	usb_event("unplug t");
	usb_event("unplug u");
	usb_event("unplug id");
	TEST_ASSERT_EQUAL_HEX8(DS2490_NRS, usb_result_of(DS2490_WIRE_RESET, 0));
	usb_comm(DS2490_WIRE_RESET | DS2490_IM | DS2490_ICP, 0);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(0, usb_look()); /* not the last of a macro: nothing is told */
}

/* Reset, Match ROM, Convert T or Read Scratchpad: by one block. */
static void block(const char *name, uint8_t function, unsigned more, unsigned bits)
{
	uint8_t bytes[10 + 9] = {0x55};

	memcpy(bytes + 1, sim_net_slave(&usb.net, name)->rom, 8);
	bytes[9] = function;
	memset(bytes + 10, 0xFF, 9);
	usb_out(bytes, 10 + more);
	usb_comm(DS2490_BLOCK | DS2490_IM | DS2490_RST | bits, 10 + more);
}

static void test_a_block_reads_a_scratchpad_in_the_time_of_its_slots(void)
{
	block("t", 0xBE, 9, 0);
	TEST_ASSERT_EQUAL_INT64(1096 * USB_US + INT64_C(19) * 8 * 68 * USB_US, usb_finish());
	TEST_ASSERT_EQUAL_INT(0, usb_look());
	TEST_ASSERT_EQUAL_UINT8(19, usb.state[DS2490_AT_IN]);
	TEST_ASSERT_EQUAL_UINT8(0, usb.state[DS2490_AT_OUT]);
	TEST_ASSERT_EQUAL_INT(19, usb_in(64));
	TEST_ASSERT_EQUAL_HEX8(0x55, usb.data[0]);
	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, usb.data + 10, 8), usb.data[18]);
	TEST_ASSERT_EQUAL_INT(-EAGAIN, usb_in(64));
}

static void test_a_block_has_no_error_codes(void)
{
	usb_event("short 0x18");
	block("t", 0xBE, 9, DS2490_NTF);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(1, usb_look());
	TEST_ASSERT_EQUAL_HEX8(0, usb.state[DS2490_STATE]);
	TEST_ASSERT_EQUAL_INT(19, usb_in(64));
	TEST_ASSERT_EQUAL_HEX8(0, usb.data[18]);
}

static void test_a_block_waits_for_bytes_that_have_not_come(void)
{
	usb_comm(DS2490_BLOCK | DS2490_IM, 2);
	TEST_ASSERT_EQUAL_INT64(0, usb_finish());
	usb.now += 50 * USB_MS;
	TEST_ASSERT_FALSE(usb_has(DS2490_IDLE));
	usb_out("\xCC\xFF", 2);
	TEST_ASSERT_EQUAL_INT64(16 * 68 * USB_US, usb_finish());
	TEST_ASSERT_TRUE(usb_has(DS2490_IDLE));
}

static void test_bits_and_bytes_come_back_unless_icp_keeps_them(void)
{
	usb_comm(DS2490_BIT | DS2490_IM | DS2490_D, 0);
	TEST_ASSERT_EQUAL_INT64(68 * USB_US, usb_finish());
	TEST_ASSERT_EQUAL_INT(1, usb_in(64));
	TEST_ASSERT_EQUAL_UINT8(1, usb.data[0]);
	usb_comm(DS2490_BIT | DS2490_IM, 0);
	usb_comm(DS2490_BYTE | DS2490_IM, 0xA7);
	usb_comm(DS2490_BYTE | DS2490_IM | DS2490_ICP, 0x11);
	usb_comm(DS2490_BIT | DS2490_IM | DS2490_ICP, 0);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(2, usb_in(64));
	TEST_ASSERT_EQUAL_UINT8(0, usb.data[0]);
	TEST_ASSERT_EQUAL_HEX8(0xA7, usb.data[1]);
}

static void test_match_access_and_read_straight(void)
{
	usb_out(sim_net_slave(&usb.net, "t")->rom, 8);
	usb_comm(DS2490_MATCH | DS2490_IM | DS2490_RST | DS2490_ICP, 0x55);
	usb_out("\xBE", 1);
	usb_comm(1 << 8 | DS2490_STRAIGHT | DS2490_IM | DS2490_STRAIGHT_NTF, 9);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(1, usb_look());
	TEST_ASSERT_EQUAL_HEX8(0, usb.state[DS2490_STATE]);
	TEST_ASSERT_EQUAL_INT(9, usb_in(64)); /* nothing of what was written */
	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, usb.data, 8), usb.data[8]);
	usb_out("\x33",
	        1); /* among several, Read ROM is the AND of all: it only shows that it was reset */
	usb_comm(1 << 8 | DS2490_STRAIGHT | DS2490_IM | DS2490_STRAIGHT_RST, 1);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(1, usb_in(64));
	TEST_ASSERT_EQUAL_HEX8(0x81 & 0x28 & 0x01, usb.data[0]);
}

static void test_a_search_reports_ids_and_where_it_could_go_on(void)
{
	static const uint8_t zero[8];
	uint8_t start[8], all[4][8];
	int turn = 63;

	usb_out(zero, 8);
	usb_comm(DS2490_SEARCH | DS2490_IM | DS2490_RST | DS2490_SM | DS2490_RTS, 0xF0);
	TEST_ASSERT_EQUAL_INT64(4 * (1096 * USB_US + 8 * 68 * USB_US + INT64_C(192) * 68 * USB_US),
	                        usb_finish());
	TEST_ASSERT_EQUAL_INT(0, usb_look());
	TEST_ASSERT_EQUAL_INT(32, usb_in(64));
	memcpy(all, usb.data, sizeof(all));
	for (unsigned i = 0; i < 4; i++)
		TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, all[i], 7), all[i][7]);

	usb_out(zero, 8);
	usb_comm(DS2490_SEARCH | DS2490_IM | DS2490_RST | DS2490_SM | DS2490_RTS, 0x01F0);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(16, usb_in(64));
	TEST_ASSERT_EQUAL_HEX8_ARRAY(all[0], usb.data, 8);
	while (!(usb.data[8 + turn / 8] >> turn % 8 & 1) || usb.data[turn / 8] >> turn % 8 & 1)
		turn--;
	memset(start, 0, 8);
	for (int i = 0; i < turn; i++)
		start[i / 8] |= (uint8_t)(usb.data[i / 8] & 1u << i % 8);
	start[turn / 8] |= (uint8_t)(1u << turn % 8);
	usb_out(start, 8);
	usb_comm(DS2490_SEARCH | DS2490_IM | DS2490_RST | DS2490_SM | DS2490_RTS, 0x03F0);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(0, usb_look());
	TEST_ASSERT_EQUAL_INT(24, usb_in(64));
	TEST_ASSERT_EQUAL_HEX8_ARRAY(all[1], usb.data, 24);

	usb_out(all[3], 8); /* to begin at the last finds it alone */
	TEST_ASSERT_EQUAL_HEX8(DS2490_EOS,
	                       usb_result_of(DS2490_SEARCH | DS2490_RST | DS2490_SM, 0x02F0));
	TEST_ASSERT_EQUAL_INT(8, usb_in(64));
}

static void test_a_search_of_a_short_wire_or_for_alarms_that_are_not_there(void)
{
	static const uint8_t zero[8];

	usb_out(zero, 8);
	TEST_ASSERT_EQUAL_HEX8(DS2490_EOS,
	                       usb_result_of(DS2490_SEARCH | DS2490_RST | DS2490_SM, 0xEC));
	usb_out(zero, 8);
	TEST_ASSERT_EQUAL_HEX8(
		DS2490_EOS,
		usb_result_of(DS2490_SEARCH | DS2490_RST | DS2490_SM | DS2490_F, 0x40F0));
	TEST_ASSERT_EQUAL_INT(32, usb_in(64)); /* F: not of that */
	usb_event("short 0x18");
	usb_out(zero, 8);
	TEST_ASSERT_EQUAL_HEX8(
		DS2490_SH, usb_result_of(DS2490_SEARCH | DS2490_RST | DS2490_SM | DS2490_F, 0xF0));
	TEST_ASSERT_EQUAL_UINT8(0, usb.state[DS2490_AT_OUT]); /* F: cleared after an error */
	TEST_ASSERT_EQUAL_INT(-EAGAIN, usb_in(64));
}

static void test_a_search_makes_for_one_device(void)
{
	usb_out(sim_net_slave(&usb.net, "t")->rom, 8);
	TEST_ASSERT_EQUAL_HEX8(0, usb_result_of(DS2490_SEARCH | DS2490_RST, 0xF0));
	usb_out("\xBE", 1);
	usb_comm(1 << 8 | DS2490_STRAIGHT | DS2490_IM, 9);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(9, usb_in(64));
	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, usb.data, 8), usb.data[8]);
	usb_event("unplug t");
	usb_out(sim_net_slave(&usb.net, "t")->rom, 8);
	TEST_ASSERT_EQUAL_HEX8(DS2490_CMP, usb_result_of(DS2490_SEARCH | DS2490_RST, 0xF0));
}

static void test_the_strong_pullup_feeds_a_conversion_for_its_time(void)
{
	usb_mode(DS2490_PULSE_EN, 2);
	usb_comm(DS2490_SET_DURATION | DS2490_IM, 48); /* 768 ms */
	block("u", 0x44, 0, DS2490_SPU);
	usb.now += 1096 * USB_US + INT64_C(80) * 68 * USB_US;
	TEST_ASSERT_TRUE(usb_has(DS2490_SPUA));
	TEST_ASSERT_FALSE(usb_has(DS2490_IDLE));
	TEST_ASSERT_EQUAL_INT(10, usb_in(64)); /* what was read is there before it ends */
	TEST_ASSERT_EQUAL_INT64(768 * USB_MS, usb_finish());
	TEST_ASSERT_FALSE(usb_has(DS2490_SPUA));
	block("u", 0xBE, 9, 0);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(19, usb_in(64));
	TEST_ASSERT_EQUAL_INT(30 * 16, usb.data[10] | usb.data[11] << 8);
	TEST_ASSERT_EQUAL_UINT64(1, sim_net_slave(&usb.net, "u")->conversions);
}

static void test_no_pullup_that_is_not_enabled_and_after_a_one_with_cib(void)
{
	usb_comm(DS2490_PULSE | DS2490_IM, 0);
	TEST_ASSERT_EQUAL_INT64(0, usb_finish());
	usb_mode(DS2490_PULSE_EN, 2);
	usb_comm(DS2490_PULSE | DS2490_IM, 0);
	TEST_ASSERT_EQUAL_INT64(512 * USB_MS, usb_finish());
	usb_comm(DS2490_BIT | DS2490_IM | DS2490_SPU | DS2490_CIB | DS2490_D, 0);
	TEST_ASSERT_EQUAL_INT64(68 * USB_US, usb_finish());
	usb_comm(DS2490_BIT | DS2490_IM | DS2490_SPU | DS2490_CIB, 0);
	TEST_ASSERT_EQUAL_INT64(512 * USB_MS + 68 * USB_US, usb_finish());
	TEST_ASSERT_EQUAL_HEX8(DS2490_VPP, usb_result_of(DS2490_PULSE | DS2490_TYPE, 0));
}

static void test_a_pulse_without_end_is_ended_by_a_halt(void)
{
	usb_mode(DS2490_PULSE_EN, 2);
	for (unsigned halt = DS2490_HALT_EXE_IDLE; halt <= DS2490_HALT_EXE_DONE; halt++) {
		usb_comm(DS2490_SET_DURATION | DS2490_IM, 0);
		usb_comm(DS2490_PULSE | DS2490_IM, 0);
		usb_finish();
		usb.now += 3000 * USB_MS;
		TEST_ASSERT_TRUE(usb_has(DS2490_SPUA));
		usb_control(halt);
		usb_finish();
		TEST_ASSERT_FALSE(usb_has(DS2490_SPUA));
		usb_control(DS2490_RESUME_EXE);
		usb_finish();
		TEST_ASSERT_TRUE(usb_has(DS2490_IDLE));
		TEST_ASSERT_FALSE(usb_has(DS2490_HALTED));
	}
}

static void test_speeds_and_their_slots(void)
{
	usb_mode(DS2490_SPEED, 1);
	usb_comm(DS2490_BYTE | DS2490_IM, 0xFF);
	TEST_ASSERT_EQUAL_INT64(8 * 69 * USB_US, usb_finish());
	usb_mode(DS2490_SAMPLE_OFFSET, 7);
	usb_comm(DS2490_BYTE | DS2490_IM, 0xFF);
	TEST_ASSERT_EQUAL_INT64(8 * 72 * USB_US, usb_finish());
	usb_comm(DS2490_WIRE_RESET | DS2490_IM | DS2490_SE, 0);
	usb_finish();
	usb_look();
	TEST_ASSERT_EQUAL_UINT8(1, usb.state[DS2490_AT_SPEED]); /* a change was not enabled */
	usb_mode(DS2490_SPEED_CHANGE_EN, 1);
	TEST_ASSERT_EQUAL_HEX8(0, usb_result_of(DS2490_WIRE_RESET | DS2490_SE, 0));
	TEST_ASSERT_EQUAL_UINT8(0, usb.state[DS2490_AT_SPEED]);
	usb_comm(DS2490_BYTE | DS2490_IM, 0x3C);
	usb_comm(DS2490_WIRE_RESET | DS2490_IM | DS2490_SE, 2);
	TEST_ASSERT_EQUAL_INT64(8 * 68 * USB_US + 140 * USB_US, usb_finish());
	usb_comm(DS2490_BYTE | DS2490_IM, 0xFF);
	TEST_ASSERT_EQUAL_INT64(80 * USB_US, usb_finish());
	TEST_ASSERT_EQUAL_INT(4, usb_in(64));
}

static void test_resets_until_a_presence_pulse(void)
{
	usb_event("unplug own");
	usb_event("unplug t");
	usb_event("unplug u");
	usb_event("unplug id");
	usb_comm(DS2490_WIRE_RESET | DS2490_IM | DS2490_NTF | DS2490_PST, 0);
	usb.now += 100 * USB_MS;
	TEST_ASSERT_FALSE(usb_has(DS2490_IDLE));
	usb_event("plug t");
	usb.now += 5 * USB_MS;
	TEST_ASSERT_EQUAL_INT(2, usb_look()); /* and that a device has come */
	TEST_ASSERT_EQUAL_HEX8(0, usb.state[DS2490_STATE]);
	TEST_ASSERT_EQUAL_HEX8(DS2490_IDLE, usb.state[DS2490_AT_FLAGS]);
}

static void test_overdrive_match_changes_the_speed_after_its_command(void)
{
	usb_mode(DS2490_SPEED_CHANGE_EN, 1);
	usb_out(sim_net_slave(&usb.net, "id")->rom, 8);
	usb_comm(DS2490_MATCH | DS2490_IM | DS2490_SE | DS2490_RST, 0x0269);
	TEST_ASSERT_EQUAL_INT64(1096 * USB_US + 8 * 68 * USB_US + 64 * 10 * USB_US, usb_finish());
	usb_look();
	TEST_ASSERT_EQUAL_UINT8(2, usb.state[DS2490_AT_SPEED]);
}

static void test_a_search_for_one_device_leaves_all_others(void)
{
	usb_out(sim_net_slave(&usb.net, "u")->rom, 8); /* not the first that a search finds */
	TEST_ASSERT_EQUAL_HEX8(0, usb_result_of(DS2490_SEARCH | DS2490_RST, 0xF0));
	usb_out("\xBE", 1);
	usb_comm(1 << 8 | DS2490_STRAIGHT | DS2490_IM, 9);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(9, usb_in(64));
	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, usb.data, 8), usb.data[8]);
}

static void test_a_pulse_of_some_time_ends_by_a_halt_at_once_or_in_its_time(void)
{
	usb_mode(DS2490_PULSE_EN, 2);
	usb_comm(DS2490_BYTE | DS2490_IM, 0xFF);
	TEST_ASSERT_EQUAL_INT64(8 * 68 * USB_US, usb_finish()); /* enabled, and not asked for */
	usb_comm(DS2490_PULSE | DS2490_IM, 0);
	usb.now += 100 * USB_MS;
	usb_control(DS2490_HALT_EXE_DONE);
	TEST_ASSERT_TRUE(usb_has(DS2490_SPUA));
	TEST_ASSERT_FALSE(usb_has(DS2490_HALTED));
	TEST_ASSERT_EQUAL_INT64(412 * USB_MS, usb_finish());
	TEST_ASSERT_TRUE(usb_has(DS2490_HALTED));
	usb_control(DS2490_RESUME_EXE);
	usb_comm(DS2490_PULSE | DS2490_IM, 0);
	usb.now += 100 * USB_MS;
	TEST_ASSERT_TRUE(usb_has(DS2490_SPUA));
	usb_control(DS2490_HALT_EXE_IDLE);
	TEST_ASSERT_FALSE(usb_has(DS2490_SPUA));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_reset_of_the_wire_says_what_it_met);
	RUN_TEST(test_a_block_reads_a_scratchpad_in_the_time_of_its_slots);
	RUN_TEST(test_a_block_has_no_error_codes);
	RUN_TEST(test_a_block_waits_for_bytes_that_have_not_come);
	RUN_TEST(test_bits_and_bytes_come_back_unless_icp_keeps_them);
	RUN_TEST(test_match_access_and_read_straight);
	RUN_TEST(test_a_search_reports_ids_and_where_it_could_go_on);
	RUN_TEST(test_a_search_of_a_short_wire_or_for_alarms_that_are_not_there);
	RUN_TEST(test_a_search_makes_for_one_device);
	RUN_TEST(test_the_strong_pullup_feeds_a_conversion_for_its_time);
	RUN_TEST(test_no_pullup_that_is_not_enabled_and_after_a_one_with_cib);
	RUN_TEST(test_a_pulse_without_end_is_ended_by_a_halt);
	RUN_TEST(test_speeds_and_their_slots);
	RUN_TEST(test_resets_until_a_presence_pulse);
	RUN_TEST(test_overdrive_match_changes_the_speed_after_its_command);
	RUN_TEST(test_a_search_for_one_device_leaves_all_others);
	RUN_TEST(test_a_pulse_of_some_time_ends_by_a_halt_at_once_or_in_its_time);
	return UNITY_END();
}
