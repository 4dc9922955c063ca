/* SPDX-License-Identifier: MIT */
/* The driver of a passive serial adapter on a simulated one. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "hal/serial/passive.h"
#include "hal/wire/search.h"
#include "tests/unit/aid/parts.h"
#include "tests/unit/aid/serial_scene.h"

static const char house[] = "chip DS2482-100 0x18\n"
			    "DS18B20 28.0000000000E3 as t temperature 21.5\n"
			    "DS2413 3A.0000000000E3 as s\n";

void setUp(void)
{
	serial_begin();
}

void tearDown(void)
{
	serial_end();
}

static void test_a_reading_is_a_reset_and_slots(void)
{
	struct link_cost before, after;

	serial_start(SIM_PASSIVE, &serial_passive, house);
	serial.wire->ops->cost(serial.wire, &before);
	unsigned reads = serial.reads;

	serial_check("t");
	TEST_ASSERT_EQUAL_UINT(reads + 2, serial.reads);
	serial.wire->ops->cost(serial.wire, &after);
	TEST_ASSERT_EQUAL_UINT64(1, after.resets - before.resets);
	TEST_ASSERT_EQUAL_UINT64(1041667 + 19 * 8 * 86806, after.wire_ns - before.wire_ns);
}

static void test_a_short_and_nobody_are_told_apart(void)
{
	serial_start(SIM_PASSIVE, &serial_passive, house);
	serial_event("short 0x18 for 10ms");
	TEST_ASSERT_EQUAL_INT(-ECOMM, part_reset(serial.wire));
	serial.host.now += 20 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	serial_event("unplug t");
	serial_event("unplug s");
	TEST_ASSERT_EQUAL_INT(0, part_reset(serial.wire));
}

/* At the speed of slots a reset pulse is none, and its echo is that of a wire without devices. */
static void test_a_speed_that_another_program_has_set_hides_the_devices_once(void)
{
	serial_start(SIM_PASSIVE, &serial_passive, house);
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	serial.baud = 115200;
	TEST_ASSERT_EQUAL_INT(0, part_reset(serial.wire));
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	serial_check("t");
}

static void test_an_echo_of_what_a_busy_machine_sent_late_is_not_taken_for_a_missing_one(void)
{
	serial_start(SIM_PASSIVE, &serial_passive, house);
	serial.late_ns = 10 * HOST_S;
	serial_check("t");
	serial.late_ns = 0;
	serial.sim.silent = true;
	uint8_t scratchpad[9];
	int64_t begun_ns = serial.host.now;

	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, serial_scratchpad("t", scratchpad));
	TEST_ASSERT_LESS_THAN_INT64(begun_ns + HOST_S, serial.host.now);
}

/* All of the wire: how many devices, and how often something was written. */
static unsigned round_of(bool alarm, unsigned *writes)
{
	unsigned begun = serial.writes, count = 0;
	struct search search;
	int found;

	search_begin(&search, alarm, 0);
	while ((found = search_next(&search, serial.wire)) > 0)
		count++;
	TEST_ASSERT_EQUAL_INT(0, found);
	*writes = serial.writes - begun;
	return count;
}

static void test_a_search_is_one_exchange_for_each_bit_and_one_in_all_for_a_known_id(void)
{
	unsigned writes;

	serial_start(SIM_PASSIVE, &serial_passive, house);
	TEST_ASSERT_EQUAL_UINT(2, round_of(false, &writes));
	TEST_ASSERT_EQUAL_UINT(2 * (2 + 64), writes);
	TEST_ASSERT_EQUAL_UINT(2, round_of(false, &writes));
	TEST_ASSERT_EQUAL_UINT(2 * 2, writes);
	TEST_ASSERT_EQUAL_UINT(0, round_of(true, &writes));
	TEST_ASSERT_EQUAL_UINT(2, writes);
	TEST_ASSERT_EQUAL_INT(
		1, search_verify(serial.wire, sim_net_slave(&serial.net, "t")->rom, false));
	TEST_ASSERT_EQUAL_INT(
		0, search_verify(serial.wire, sim_net_slave(&serial.net, "t")->rom, true));
}

/* What came and what went is seen at once, and is known after a search or two. */
static void test_a_search_that_leads_elsewhere_than_it_did_goes_on_bit_by_bit(void)
{
	static const uint8_t absent[8] = {0x28, 1, 2, 3, 4, 5, 6, 0x7b};
	unsigned writes;

	serial_start(SIM_PASSIVE, &serial_passive, house);
	serial_event("unplug t");
	TEST_ASSERT_EQUAL_UINT(1, round_of(false, &writes));
	serial_event("plug t");
	TEST_ASSERT_EQUAL_UINT(2, round_of(false, &writes));
	/* the two part in the second bit */
	TEST_ASSERT_EQUAL_UINT(2 + 2 + 62 + 2 + 64, writes);
	TEST_ASSERT_EQUAL_UINT(2, round_of(false, &writes));
	TEST_ASSERT_EQUAL_UINT(2 * 2, writes);
	serial_event("unplug t");
	TEST_ASSERT_EQUAL_UINT(1, round_of(false, &writes));
	TEST_ASSERT_EQUAL_UINT(2 + 2 + 62, writes);
	TEST_ASSERT_EQUAL_UINT(1, round_of(false, &writes));
	TEST_ASSERT_EQUAL_UINT(2, writes);
	TEST_ASSERT_EQUAL_INT(
		0, search_verify(serial.wire, sim_net_slave(&serial.net, "t")->rom, false));
	serial_event("plug t");
	TEST_ASSERT_EQUAL_UINT(2, round_of(false, &writes));
	TEST_ASSERT_EQUAL_INT(0, search_verify(serial.wire, absent, false));
	TEST_ASSERT_EQUAL_UINT(2, round_of(false, &writes));
}

/* Whatever comes back wrong: a true id, none, or an error. */
static void test_a_wrong_bit_in_a_search_for_a_known_id_makes_no_other_id(void)
{
	unsigned writes, good = 0;

	serial_start(SIM_PASSIVE, &serial_passive, house);
	TEST_ASSERT_EQUAL_UINT(2, round_of(false, &writes));
	for (unsigned i = 0; i < 200; i++) {
		struct search search;

		serial.sim.answered = 8 * 400 - 2 - i;
		serial.sim.noise_each = 400;
		search_begin(&search, false, 0);
		int found = search_next(&search, serial.wire);

		serial.sim.noise_each = 0;
		good += found == 1;
		if (found == 1)
			TEST_ASSERT_EQUAL_HEX8_ARRAY(sim_net_slave(&serial.net, "t")->rom,
			                             search.rom, 8);
		else
			TEST_ASSERT_LESS_OR_EQUAL_INT(0, found);
	}
	TEST_ASSERT_GREATER_THAN_UINT(0, good);
	TEST_ASSERT_LESS_THAN_UINT(200, good);
	TEST_ASSERT_EQUAL_UINT(2, round_of(false, &writes));
	TEST_ASSERT_EQUAL_UINT(2, round_of(false, &writes));
	TEST_ASSERT_EQUAL_UINT(2 * 2, writes);
}

static void test_there_is_no_strong_pull_up(void)
{
	uint8_t byte = 0x44;
	uint64_t sent;

	serial_start(SIM_PASSIVE, &serial_passive, house);
	TEST_ASSERT_FALSE(serial.wire->facts->strong);
	sent = serial.sim.bytes;
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, part_write(serial.wire, &byte, 1, LINK_STRONG));
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, link_slot(serial.wire, true, LINK_STRONG));
	TEST_ASSERT_EQUAL_UINT64(sent, serial.sim.bytes);
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, serial.wire->ops->recover(serial.wire, LINK_CHIP_RESET));
}

static void test_what_is_there_in_place_of_a_passive_adapter_is_named(void)
{
	serial_make(SIM_DS2480B, &serial_passive, house);
	TEST_ASSERT_EQUAL_INT(-ENXIO, serial_try());
	TEST_ASSERT_NOT_NULL(strstr(serial.why, "is serial:port"));
	tearDown();
	setUp();
	serial_make(SIM_PASSIVE, &serial_passive, house);
	serial.sim.noise_each = 1;
	serial.sim.answered = 8; /* the lowest bit of the next answer is turned */
	serial.sim.noise_each = 3;
	TEST_ASSERT_EQUAL_INT(-EIO, serial_try());
	TEST_ASSERT_NOT_NULL(strstr(serial.why, "does not give back what is sent"));
	serial.sim.noise_each = 0;
	TEST_ASSERT_EQUAL_INT(0, serial_try());
}

static void test_a_byte_that_does_not_come_back_as_it_was_written_is_an_error(void)
{
	uint8_t scratchpad[9];
	unsigned errors = 0;

	serial_start(SIM_PASSIVE, &serial_passive, house);
	for (unsigned i = 0; i < 80; i++) {
		serial.sim.answered = 8 * 200 - 1 - i;
		serial.sim.noise_each = 200;
		errors += serial_scratchpad("t", scratchpad) == -EIO;
		serial.sim.noise_each = 0;
		serial_check("t");
	}
	TEST_ASSERT_EQUAL_UINT(80, errors);
}

/* The pulse itself is low whatever answers; a direction that is not taken leads another way. */
static void test_a_pulse_and_a_direction_that_do_not_come_back_are_errors(void)
{
	uint8_t command = ONEWIRE_SEARCH, rom[8] = {0}, conflict[8], byte = 0;
	const struct link_part part = {.reset = true, .out = &command, .out_n = 1};
	uint64_t sent;

	serial_start(SIM_PASSIVE, &serial_passive, house);
	for (unsigned bit = 0; bit < 4; bit++) {
		serial.sim.answered = 7 + bit;
		serial.sim.noise_each = 1;
		TEST_ASSERT_EQUAL_INT(-EIO, serial.wire->ops->run(serial.wire, &part));
		serial.sim.noise_each = 0;
		/* not a byte goes out until there is a reset */
		sent = serial.sim.bytes;
		TEST_ASSERT_EQUAL_INT(-EIO, part_read(serial.wire, &byte, 1));
		TEST_ASSERT_EQUAL_INT(-EIO, link_slot(serial.wire, true, LINK_IDLE));
		TEST_ASSERT_EQUAL_INT(-EIO, serial.wire->ops->path(serial.wire, false,
		                                                   ONEWIRE_SEARCH, rom, conflict));
		TEST_ASSERT_EQUAL_UINT64(sent, serial.sim.bytes);
	}
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	serial.sim.answered = 8 * 200 - 11; /* bit 0 of the third answer after the command */
	serial.sim.noise_each = 200;
	TEST_ASSERT_EQUAL_INT(
		-EIO, serial.wire->ops->path(serial.wire, false, ONEWIRE_SEARCH, rom, conflict));
	serial.sim.noise_each = 0;
	serial_check("t");
}

static void test_a_path_leads_where_it_is_told_and_ends_where_nobody_answers(void)
{
	uint8_t rom[8] = {0x3A}, conflict[8];

	serial_start(SIM_PASSIVE, &serial_passive, house);
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	TEST_ASSERT_EQUAL_INT(
		0, serial.wire->ops->path(serial.wire, false, ONEWIRE_SEARCH, rom, conflict));
	TEST_ASSERT_EQUAL_HEX8(0x3A, rom[0]);
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	for (unsigned i = 0; i < 2; i++) {
		const struct sim_event pull = {.what = SIM_PLUG,
		                               .slave = serial.net.chip[0].wire[0].slaves[i],
		                               .at_ns = serial.net.time + 3 * HOST_MS};

		TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(&serial.net, &pull));
	}
	TEST_ASSERT_EQUAL_INT(-EBADMSG, serial.wire->ops->path(serial.wire, false, ONEWIRE_SEARCH,
	                                                       rom, conflict));
}

/* More than goes at once, there and back. */
static void test_a_long_transaction_goes_in_pieces(void)
{
	uint8_t out[50] = {0}, in[70];
	const struct link_part part = {
		.reset = true, .out = out, .out_n = 50, .in = in, .in_n = sizeof(in)};
	uint64_t sent;

	serial_start(SIM_PASSIVE, &serial_passive, house);
	sent = serial.sim.bytes;
	memset(in, 0, sizeof(in));
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->run(serial.wire, &part));
	TEST_ASSERT_EQUAL_UINT64(sent + 1 + (50 + 70) * 8, serial.sim.bytes);
	for (unsigned i = 0; i < sizeof(in); i++)
		TEST_ASSERT_EQUAL_HEX8(0xFF, in[i]);
}

static void test_a_port_without_the_speeds_is_named_and_is_taken_when_it_has_them(void)
{
	static const unsigned speeds[] = {9600, 115200};

	serial_make(SIM_PASSIVE, &serial_passive, house);
	for (unsigned i = 0; i < 2; i++) {
		serial.no_speed = speeds[i];
		TEST_ASSERT_NOT_EQUAL_INT(0, serial_try());
		TEST_ASSERT_NOT_EQUAL_INT(-ETIMEDOUT, serial_try());
	}
	TEST_ASSERT_NOT_NULL(strstr(serial.why, "cannot have the speeds of a passive adapter"));
	serial.no_speed = 0;
	TEST_ASSERT_EQUAL_INT(0, serial_try());
	/* refused once, it is asked for again */
	serial.no_speed = 9600;
	TEST_ASSERT_EQUAL_INT(-EIO, part_reset(serial.wire));
	serial.no_speed = 0;
	serial_check("t");
}

static void test_pulled_anywhere_the_adapter_is_gone_and_is_back(void)
{
	uint8_t scratchpad[9];

	serial_start(SIM_PASSIVE, &serial_passive, house);
	for (unsigned n = 1; n < 150; n += 7) {
		serial.pull_at = serial.sim.bytes + n;
		TEST_ASSERT_EQUAL_INT(-ENODEV, serial_scratchpad("t", scratchpad));
		serial.master->ops->close(serial.master);
		TEST_ASSERT_EQUAL_INT(-ENODEV, part_reset(serial.wire));
		serial.pulled = false;
		serial.pull_at = 0;
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, serial_try(), serial.why);
		serial_check("t");
	}
}

static void test_silence_is_an_error_in_time(void)
{
	uint8_t scratchpad[9];
	int64_t begun;

	serial_start(SIM_PASSIVE, &serial_passive, house);
	serial.sim.silent = true;
	begun = serial.host.now;
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, serial_scratchpad("t", scratchpad));
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, serial.wire->ops->recover(serial.wire, LINK_BUS_RESET));
	TEST_ASSERT_LESS_THAN_INT64(HOST_S, serial.host.now - begun);
	serial.sim.silent = false;
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->recover(serial.wire, LINK_BUS_RESET));
	serial_check("t");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_reading_is_a_reset_and_slots);
	RUN_TEST(test_a_speed_that_another_program_has_set_hides_the_devices_once);
	RUN_TEST(test_an_echo_of_what_a_busy_machine_sent_late_is_not_taken_for_a_missing_one);
	RUN_TEST(test_a_short_and_nobody_are_told_apart);
	RUN_TEST(test_a_search_is_one_exchange_for_each_bit_and_one_in_all_for_a_known_id);
	RUN_TEST(test_a_search_that_leads_elsewhere_than_it_did_goes_on_bit_by_bit);
	RUN_TEST(test_a_wrong_bit_in_a_search_for_a_known_id_makes_no_other_id);
	RUN_TEST(test_there_is_no_strong_pull_up);
	RUN_TEST(test_what_is_there_in_place_of_a_passive_adapter_is_named);
	RUN_TEST(test_a_byte_that_does_not_come_back_as_it_was_written_is_an_error);
	RUN_TEST(test_a_pulse_and_a_direction_that_do_not_come_back_are_errors);
	RUN_TEST(test_a_path_leads_where_it_is_told_and_ends_where_nobody_answers);
	RUN_TEST(test_a_long_transaction_goes_in_pieces);
	RUN_TEST(test_a_port_without_the_speeds_is_named_and_is_taken_when_it_has_them);
	RUN_TEST(test_pulled_anywhere_the_adapter_is_gone_and_is_back);
	RUN_TEST(test_silence_is_an_error_in_time);
	return UNITY_END();
}
