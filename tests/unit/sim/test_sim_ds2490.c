/* SPDX-License-Identifier: MIT */
/* The USB side of the simulated DS2490 against the tables of its data sheet. */
#include <errno.h>
#include <string.h>

#include "unity.h"

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

static void test_descriptors_have_the_four_alternate_settings(void)
{
	static const struct {
		uint8_t interval, packet;
	} alternates[] = {{10, 16}, {10, 64}, {1, 16}, {1, 64}};

	TEST_ASSERT_EQUAL_INT(18, usb_request(0x80, 6, 0x100, 0, 64));
	TEST_ASSERT_EQUAL_HEX8_ARRAY(((uint8_t[]){0xFA, 0x04, 0x90, 0x24}), usb.data + 8, 4);
	TEST_ASSERT_EQUAL_INT(129, usb_request(0x80, 6, 0x200, 0, 255));
	for (unsigned i = 0; i < 4; i++) {
		const uint8_t *at = usb.data + 9 + 30 * i;

		TEST_ASSERT_EQUAL_UINT8(i, at[3]);
		TEST_ASSERT_EQUAL_UINT8(alternates[i].interval, at[9 + 6]);
		TEST_ASSERT_EQUAL_UINT8(alternates[i].packet, at[9 + 7 + 4]);
		TEST_ASSERT_EQUAL_UINT8(alternates[i].packet, at[9 + 14 + 4]);
	}
	TEST_ASSERT_EQUAL_INT(-EPIPE, usb_request(0x80, 6, 0x300, 0, 255));
	TEST_ASSERT_EQUAL_INT64(1 * USB_MS, sim_ds2490_poll_ns(&usb.chip));
	TEST_ASSERT_EQUAL_INT(0, usb_request(0x01, 11, 1, 0, 0));
	TEST_ASSERT_EQUAL_INT64(10 * USB_MS, sim_ds2490_poll_ns(&usb.chip));
	TEST_ASSERT_EQUAL_INT(1, usb_request(0x81, 10, 0, 0, 1));
	TEST_ASSERT_EQUAL_UINT8(1, usb.data[0]);
	usb.allowed++;
	TEST_ASSERT_EQUAL_INT(-EPIPE, usb_request(0x01, 11, 4, 0, 0));
}

static void test_the_state_after_power_on_and_after_a_reset_of_the_device(void)
{
	static const uint8_t power_on[] = {0, 0, 0x20, 0x40, 5, 4, 4, 0, DS2490_IDLE};

	TEST_ASSERT_EQUAL_INT(0, usb_look());
	TEST_ASSERT_EQUAL_HEX8_ARRAY(power_on, usb.state, sizeof(power_on));
	for (unsigned i = DS2490_AT_COMMAND; i < DS2490_STATE; i++)
		TEST_ASSERT_EQUAL_UINT8(0, usb.state[i]);
	usb_mode(DS2490_PULSE_EN, 2);
	usb_mode(DS2490_SPEED_CHANGE_EN, 1);
	for (unsigned code = DS2490_SPEED; code <= DS2490_SAMPLE_OFFSET; code++)
		usb_mode(code, code == DS2490_SPEED ? 1 : code);
	TEST_ASSERT_EQUAL_INT(0, usb_look());
	TEST_ASSERT_EQUAL_HEX8_ARRAY(((uint8_t[]){0x05, 1, 3, 5, 4, 6, 7}), usb.state, 7);
	usb_out("abc", 3);
	usb_control(DS2490_RESET_DEVICE);
	TEST_ASSERT_EQUAL_INT(0, usb_look());
	TEST_ASSERT_EQUAL_HEX8_ARRAY(power_on, usb.state, sizeof(power_on));
	TEST_ASSERT_EQUAL_UINT8(0, usb.state[DS2490_AT_OUT]);
}

static void test_a_device_that_comes_is_told_without_being_asked_for(void)
{
	usb_event("unplug id");
	TEST_ASSERT_EQUAL_INT(0, usb_look());
	usb_event("plug id");
	TEST_ASSERT_EQUAL_INT(1, usb_look());
	TEST_ASSERT_EQUAL_HEX8(DS2490_DETECT, usb.state[DS2490_STATE]);
	TEST_ASSERT_EQUAL_INT(0, usb_look());
}

static void test_a_halted_chip_keeps_its_commands_until_it_is_resumed(void)
{
	usb_control(DS2490_HALT_EXE_DONE);
	TEST_ASSERT_TRUE(usb_has(DS2490_HALTED));
	usb_comm(DS2490_BYTE | DS2490_IM, 0x12);
	usb_comm(DS2490_BYTE | DS2490_IM, 0x34);
	TEST_ASSERT_EQUAL_INT64(0, usb_finish());
	usb_look();
	TEST_ASSERT_EQUAL_UINT8(6, usb.state[DS2490_AT_COMMANDS]);
	TEST_ASSERT_EQUAL_INT(3, usb_request(0xC0, DS2490_CONTROL, DS2490_GET_COMM, 0, 3));
	TEST_ASSERT_EQUAL_HEX8_ARRAY(((uint8_t[]){0x53, 0x00, 0x12}), usb.data, 3);
	usb_control(DS2490_RESUME_EXE);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(1, usb_in(64));
	TEST_ASSERT_EQUAL_HEX8(0x34, usb.data[0]);
}

static void test_fifos_are_flushed_in_a_halted_chip_alone(void)
{
	usb_out("abc", 3);
	usb_control(DS2490_FLUSH_XMT);
	usb.allowed++;
	usb_look();
	TEST_ASSERT_EQUAL_UINT8(3, usb.state[DS2490_AT_OUT]);
	usb_comm(DS2490_BYTE | DS2490_IM, 0x12);
	usb_finish();
	usb_control(DS2490_HALT_EXE_IDLE);
	usb_comm(DS2490_BYTE | DS2490_IM, 0x12);
	usb_control(DS2490_FLUSH_XMT);
	usb_control(DS2490_FLUSH_RCV);
	usb_control(DS2490_FLUSH_COMM);
	usb_look();
	TEST_ASSERT_EQUAL_UINT8(0, usb.state[DS2490_AT_OUT]);
	TEST_ASSERT_EQUAL_UINT8(0, usb.state[DS2490_AT_IN]);
	TEST_ASSERT_EQUAL_UINT8(0, usb.state[DS2490_AT_COMMANDS]);
}

static void test_a_macro_waits_for_its_start(void)
{
	usb_comm(DS2490_WIRE_RESET | DS2490_ICP, 0);
	usb_comm(DS2490_BYTE | DS2490_ICP, 0xCC);
	TEST_ASSERT_EQUAL_INT64(0, usb_finish());
	usb_look();
	TEST_ASSERT_EQUAL_UINT8(6, usb.state[DS2490_AT_COMMANDS]);
	usb_control(DS2490_START_EXE);
	TEST_ASSERT_EQUAL_INT64(1096 * USB_US + 8 * 68 * USB_US, usb_finish());
	usb_comm(DS2490_WIRE_RESET | DS2490_ICP, 0);
	usb_comm(DS2490_BYTE | DS2490_NTF | DS2490_IM, 0xCC);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(1, usb_look());
	TEST_ASSERT_EQUAL_INT(1, usb_in(64));
}

static void test_only_a_reset_helps_a_full_fifo_of_ep0(void)
{
	for (unsigned i = 0; i < 4; i++)
		usb_comm(DS2490_BLOCK, 1); /* 16 bytes */
	usb_comm(DS2490_BLOCK, 1);         /* waits in EP0 */
	TEST_ASSERT_FALSE(usb_has(DS2490_EP0F));
	usb_comm(DS2490_BLOCK, 1);
	usb.allowed++;
	TEST_ASSERT_TRUE(usb_has(DS2490_EP0F));
	usb_control(DS2490_START_EXE);
	usb.allowed++;
	TEST_ASSERT_EQUAL_INT64(0, usb_finish());
	usb_control(DS2490_RESET_DEVICE);
	TEST_ASSERT_FALSE(usb_has(DS2490_EP0F));
	TEST_ASSERT_EQUAL_UINT8(0, usb.state[DS2490_AT_COMMANDS]);
}

static void test_ep2_takes_whole_packets_and_ep3_overflows(void)
{
	static const uint8_t many[200];

	TEST_ASSERT_EQUAL_INT(128, sim_ds2490_bulk_out(&usb.chip, many, 200, usb.now));
	TEST_ASSERT_EQUAL_INT(-EAGAIN, sim_ds2490_bulk_out(&usb.chip, many, 72, usb.now));
	usb_comm(DS2490_BLOCK | DS2490_IM, 200);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(72, sim_ds2490_bulk_out(&usb.chip, many, 72, usb.now));
	usb_finish();
	TEST_ASSERT_EQUAL_UINT64(72, usb.chip.faults.data_lost);
	usb.allowed += 72;
	TEST_ASSERT_EQUAL_INT(64, usb_in(64));
	TEST_ASSERT_EQUAL_INT(64, usb_in(128));
}

static void test_a_host_with_too_little_room_loses_all(void)
{
	usb_out("abc", 3);
	usb_comm(DS2490_BLOCK | DS2490_IM, 3);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(-EOVERFLOW, usb_in(2));
	usb.allowed++;
	TEST_ASSERT_EQUAL_INT(-EAGAIN, usb_in(64));
	TEST_ASSERT_EQUAL_INT(-EOVERFLOW, sim_ds2490_interrupt(&usb.chip, usb.state, 15, usb.now));
	usb.allowed++;
}

static void test_what_the_chip_does_not_know_it_stalls(void)
{
	static const unsigned codes[] = {0x0092, 0x00A2, 0x00B2, 0x00C4, 0x00D4, 0x21E4, 0x0000};

	for (unsigned i = 0; i < sizeof(codes) / sizeof(codes[0]); i++)
		TEST_ASSERT_EQUAL_INT(-EPIPE, usb_request(0x40, DS2490_COMM, codes[i], 0, 0));
	TEST_ASSERT_EQUAL_INT(-EPIPE, usb_request(0x40, DS2490_CONTROL, 11, 0, 0));
	TEST_ASSERT_EQUAL_INT(-EPIPE, usb_request(0x40, DS2490_MODE, 8, 0, 0));
	TEST_ASSERT_EQUAL_INT(-EPIPE, usb_request(0x40, 3, 0, 0, 0));
	TEST_ASSERT_EQUAL_INT(-EPIPE, usb_request(0x40, DS2490_CONTROL, 1, 0, 1));
	usb.allowed += 11;
	usb_mode(DS2490_SPEED, 3);
	usb_comm(DS2490_SET_DURATION | DS2490_IM, 0xFF);
	usb.allowed += 2;
}

static void test_faults_that_can_be_switched_on(void)
{
	usb.chip.stalled = 1 << 3;
	TEST_ASSERT_EQUAL_INT(-EPIPE, usb_in(64));
	TEST_ASSERT_EQUAL_INT(0, usb_request(0x02, 1, 0, 0x83, 0));
	TEST_ASSERT_EQUAL_INT(-EAGAIN, usb_in(64));
	usb.chip.silent = 1 << 1;
	TEST_ASSERT_EQUAL_INT(
		-EAGAIN, sim_ds2490_interrupt(&usb.chip, usb.state, sizeof(usb.state), usb.now));
	usb.chip.silent = 0;
	usb_mode(DS2490_PULSE_EN, 2);
	usb_comm(DS2490_PULSE | DS2490_IM, 0);
	usb_event("remove adapter");
	TEST_ASSERT_EQUAL_INT(-ENODEV, usb_in(64));
	TEST_ASSERT_EQUAL_INT(-ENODEV, usb_request(0x40, DS2490_CONTROL, 0, 0, 0));
	usb_event("end remove adapter");
	TEST_ASSERT_EQUAL_INT(0, usb_look()); /* as after power-on */
	TEST_ASSERT_EQUAL_HEX8(DS2490_IDLE, usb.state[DS2490_AT_FLAGS]);
	TEST_ASSERT_EQUAL_HEX8(0, usb.state[DS2490_AT_ENABLE]);
	TEST_ASSERT_EQUAL_UINT8(0, usb.chip.alternate);
}

static void test_a_halt_waits_for_the_wire_or_for_the_command(void)
{
	static const uint8_t four[4] = {1, 2, 3, 4};

	usb_out(four, 4);
	usb_comm(DS2490_BLOCK | DS2490_IM, 4);
	usb.now += 700 * USB_US; /* in the second byte */
	usb_control(DS2490_HALT_EXE_IDLE);
	TEST_ASSERT_FALSE(usb_has(DS2490_HALTED));
	usb_finish();
	TEST_ASSERT_TRUE(usb_has(DS2490_HALTED));
	TEST_ASSERT_EQUAL_UINT8(2, usb.state[DS2490_AT_IN]);
	usb_control(DS2490_RESUME_EXE);
	usb.now += 700 * USB_US;
	usb_control(DS2490_HALT_EXE_DONE);
	usb_finish();
	TEST_ASSERT_TRUE(usb_has(DS2490_HALTED));
	TEST_ASSERT_EQUAL_UINT8(4, usb.state[DS2490_AT_IN]);
}

static void test_what_comes_after_a_macro_waits_for_a_start_of_its_own(void)
{
	usb_comm(DS2490_BYTE | DS2490_IM, 0x12);
	usb_finish();
	usb_comm(DS2490_BYTE, 0x34);
	TEST_ASSERT_EQUAL_INT64(0, usb_finish());
	usb.now += 10 * USB_MS;
	TEST_ASSERT_EQUAL_INT(1, usb_in(64));
	TEST_ASSERT_EQUAL_INT(-EAGAIN, usb_in(64));
}

static void test_sixteen_results_wait_and_no_more(void)
{
	for (unsigned i = 0; i < 17; i++) {
		usb_comm(DS2490_BIT | DS2490_IM | DS2490_NTF, 0);
		usb_finish();
	}
	TEST_ASSERT_EQUAL_UINT64(1, usb.chip.faults.results_lost);
	usb.allowed++;
	TEST_ASSERT_EQUAL_INT(32, sim_ds2490_interrupt(&usb.chip, usb.state, 32, usb.now));
	usb_comm(DS2490_BIT | DS2490_IM | DS2490_NTF, 0);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(-EOVERFLOW, sim_ds2490_interrupt(&usb.chip, usb.state, 16, usb.now));
	usb.allowed++;
	TEST_ASSERT_EQUAL_INT(16, sim_ds2490_interrupt(&usb.chip, usb.state, 16, usb.now));
}

static void test_a_reset_of_the_device_frees_the_fifo_of_ep0(void)
{
	for (unsigned i = 0; i < 5; i++)
		usb_comm(DS2490_BLOCK, 1);
	usb_control(DS2490_RESET_DEVICE);
	usb_comm(DS2490_BYTE | DS2490_IM, 0x5A);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(1, usb_in(64));
	TEST_ASSERT_EQUAL_HEX8(0x5A, usb.data[0]);
	TEST_ASSERT_EQUAL_INT(0, usb_request(0xC0, DS2490_CONTROL, DS2490_GET_COMM, 0, 4));
	TEST_ASSERT_EQUAL_UINT64(1, usb.chip.faults.unhalted);
	usb.allowed++;
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_descriptors_have_the_four_alternate_settings);
	RUN_TEST(test_the_state_after_power_on_and_after_a_reset_of_the_device);
	RUN_TEST(test_a_device_that_comes_is_told_without_being_asked_for);
	RUN_TEST(test_a_halted_chip_keeps_its_commands_until_it_is_resumed);
	RUN_TEST(test_fifos_are_flushed_in_a_halted_chip_alone);
	RUN_TEST(test_a_macro_waits_for_its_start);
	RUN_TEST(test_only_a_reset_helps_a_full_fifo_of_ep0);
	RUN_TEST(test_ep2_takes_whole_packets_and_ep3_overflows);
	RUN_TEST(test_a_host_with_too_little_room_loses_all);
	RUN_TEST(test_what_the_chip_does_not_know_it_stalls);
	RUN_TEST(test_faults_that_can_be_switched_on);
	RUN_TEST(test_a_halt_waits_for_the_wire_or_for_the_command);
	RUN_TEST(test_what_comes_after_a_macro_waits_for_a_start_of_its_own);
	RUN_TEST(test_sixteen_results_wait_and_no_more);
	RUN_TEST(test_a_reset_of_the_device_frees_the_fifo_of_ep0);
	return UNITY_END();
}
