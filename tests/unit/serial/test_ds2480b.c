/* SPDX-License-Identifier: MIT */
/* The driver of the DS2480B on a simulated one: transactions, searches, pull-ups, recovery. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "hal/serial/ds2480b.h"
#include "hal/wire/search.h"
#include "tests/unit/aid/parts.h"
#include "tests/unit/aid/serial_scene.h"

/* An E3 in an id is a command to the adapter, unless it is doubled. */
static const char house[] = "chip DS2482-100 0x18\n"
			    "DS18B20 28.0000000000E3 as t temperature 21.5\n"
			    "DS18B20 28.0000000000A2 as u temperature 85 parasite\n"
			    "DS2413 3A.0000000000E3 as s\n"
			    "DS2401 01.000000000001\n";
static const char nobody[] = "chip DS2482-100 0x18\n";

void setUp(void)
{
	serial_begin();
}

void tearDown(void)
{
	/* whatever a test does, the adapter's one byte of buffer never overflows */
	TEST_ASSERT_EQUAL_UINT64(0, serial.sim.overruns);
	serial_end();
}

static void test_a_reading_is_one_write_and_one_read_and_takes_the_time_of_its_bytes(void)
{
	int64_t begun;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	unsigned writes = serial.writes, reads = serial.reads;
	begun = serial.host.now;
	serial_check("t");
	TEST_ASSERT_EQUAL_UINT(writes + 1, serial.writes);
	TEST_ASSERT_EQUAL_UINT(reads + 1, serial.reads);
	TEST_ASSERT_LESS_THAN_INT64(27 * HOST_MS, serial.host.now - begun);
}

/* Slew rate 1.37 V/us, a pull-up without end, write-1 low 10 us, sample offset 8 us; flexible. */
static void test_the_chip_is_set_up_for_long_lines_and_kept_at_flexible_speed(void)
{
	struct search search;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	TEST_ASSERT_EQUAL_UINT(3, serial.sim.parameter[1]);
	TEST_ASSERT_EQUAL_UINT(7, serial.sim.parameter[3]);
	TEST_ASSERT_EQUAL_UINT(2, serial.sim.parameter[4]);
	TEST_ASSERT_EQUAL_UINT(5, serial.sim.parameter[5]);
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	TEST_ASSERT_EQUAL_UINT(1, serial.sim.speed);
	TEST_ASSERT_EQUAL_INT(1, link_slot(serial.wire, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_UINT(1, serial.sim.speed);
	search_begin(&search, false, 0);
	TEST_ASSERT_EQUAL_INT(1, search_next(&search, serial.wire));
	TEST_ASSERT_EQUAL_UINT(1, serial.sim.speed);
}

/* The first reset after a break, from which the chip takes its time base, and a second one. */
static void test_a_chip_is_reset_by_break_and_slow_byte_and_gets_its_time_base(void)
{
	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	TEST_ASSERT_EQUAL_UINT64(2, serial.sim.master_resets);
	TEST_ASSERT_EQUAL_UINT(1, serial.breaks);
	TEST_ASSERT_EQUAL_UINT64(2, serial.net.chip[0].wire[0].resets);
}

static void test_settings_that_do_not_come_back_are_an_error(void)
{
	for (unsigned turned = 3; turned <= 6; turned++) {
		serial_make(SIM_DS2480B, &serial_ds2480b, house);
		serial.sim.noise_each = turned; /* the answers before are those of two resets */
		TEST_ASSERT_EQUAL_INT(-EIO, serial_try());
		tearDown();
		setUp();
	}
}

static void test_a_port_that_never_falls_silent_is_given_up(void)
{
	int64_t begun;

	serial_make(SIM_DS2480B, &serial_ds2480b, house);
	serial.babbles = true;
	begun = serial.host.now;
	TEST_ASSERT_EQUAL_INT(-ENXIO, serial_try());
	TEST_ASSERT_LESS_THAN_INT64(2 * HOST_S, serial.host.now - begun);
	serial.babbles = false;
	TEST_ASSERT_EQUAL_INT(0, serial_try());
}

static void test_bytes_that_are_commands_reach_the_wire_as_data(void)
{
	static const uint8_t bytes[] = {0xE1, 0xE3, 0xE3, 0xF1, 0xC5, 0xE3};
	uint8_t out[10 + sizeof(bytes)] = {0x55}, back[9];
	const struct link_part write = {.reset = true, .out = out, .out_n = 13};

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	memcpy(out + 1, sim_net_slave(&serial.net, "t")->rom, 8);
	out[9] = 0x4E;
	memcpy(out + 10, bytes, sizeof(bytes));
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->run(serial.wire, &write));
	TEST_ASSERT_EQUAL_INT(0, serial_scratchpad("t", back));
	TEST_ASSERT_EQUAL_HEX8(0xE1, back[2]);
	TEST_ASSERT_EQUAL_HEX8(0xE3, back[3]);
}

static void test_a_long_transaction_goes_in_pieces(void)
{
	uint8_t out[150], in[150];
	const struct link_part part = {
		.reset = true, .out = out, .out_n = 150, .in = in, .in_n = 150};
	struct link_cost before, after;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	serial.wire->ops->cost(serial.wire, &before);
	memset(out, 0, sizeof(out));
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->run(serial.wire, &part));
	for (unsigned i = 0; i < sizeof(in); i++)
		TEST_ASSERT_EQUAL_HEX8(0xFF, in[i]);
	serial.wire->ops->cost(serial.wire, &after);
	TEST_ASSERT_EQUAL_UINT64(1, after.resets - before.resets);
}

static void test_a_short_and_nobody_are_told_apart(void)
{
	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	serial_event("short 0x18 for 10ms");
	TEST_ASSERT_EQUAL_INT(-ECOMM, part_reset(serial.wire));
	serial.host.now += 20 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	tearDown();
	setUp();
	serial_start(SIM_DS2480B, &serial_ds2480b, nobody);
	TEST_ASSERT_EQUAL_INT(0, part_reset(serial.wire));
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->recover(serial.wire, LINK_CHIP_RESET));
}

static unsigned found_by(bool alarm, uint8_t family)
{
	struct search search;
	unsigned count = 0;

	search_begin(&search, alarm, family);
	for (int found = 1; found == 1 && count < 20; count += found == 1) {
		found = search_next(&search, serial.wire);
		TEST_ASSERT_GREATER_OR_EQUAL_INT(0, found);
		if (found == 1)
			TEST_ASSERT_TRUE(!family || search.rom[0] == family);
	}
	return count;
}

static void test_the_accelerator_finds_all_devices_of_a_family_of_an_alarm_or_none(void)
{
	unsigned writes;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	writes = serial.writes;
	TEST_ASSERT_EQUAL_UINT(4, found_by(false, 0));
	TEST_ASSERT_EQUAL_UINT(writes + 4, serial.writes); /* one for each */
	TEST_ASSERT_EQUAL_UINT(2, found_by(false, 0x28));
	TEST_ASSERT_EQUAL_UINT(1, found_by(false, 0x3A));
	TEST_ASSERT_EQUAL_UINT(0, found_by(false, 0x29));
	TEST_ASSERT_EQUAL_UINT(0, found_by(true, 0));
	serial_check("t");
}

static void test_a_search_for_one_id_says_whether_it_is_there_and_leaves_it_selected(void)
{
	static const uint8_t absent[8] = {0x28, 1, 2, 3, 4, 5, 6, 0x7b};
	const uint8_t *rom;
	uint8_t state = 0;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	rom = sim_net_slave(&serial.net, "s")->rom;
	TEST_ASSERT_EQUAL_INT(1, search_verify(serial.wire, rom, false));
	state = 0xF5; /* PIO access read */
	TEST_ASSERT_EQUAL_INT(0, part_write(serial.wire, &state, 1, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(0, part_read(serial.wire, &state, 1));
	TEST_ASSERT_EQUAL_HEX8(0x0F, (state & 0x0F) ^ (state >> 4 & 0x0F));
	TEST_ASSERT_EQUAL_INT(0, search_verify(serial.wire, absent, false));
	TEST_ASSERT_EQUAL_INT(0, search_verify(serial.wire, rom, true));
}

static void test_a_path_that_breaks_off_turns_the_accelerator_off_and_is_an_error(void)
{
	uint8_t rom[8] = {0}, conflict[8];

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	for (unsigned i = 0; i < 4; i++) {
		const struct sim_event pull = {.what = SIM_PLUG,
		                               .slave = serial.net.chip[0].wire[0].slaves[i],
		                               .at_ns = serial.net.time + 10 * HOST_MS};

		TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(&serial.net, &pull));
	}
	TEST_ASSERT_EQUAL_INT(-EBADMSG, serial.wire->ops->path(serial.wire, false, ONEWIRE_SEARCH,
	                                                       rom, conflict));
	TEST_ASSERT_FALSE(serial.sim.search);
	TEST_ASSERT_EQUAL_INT(0, part_reset(serial.wire));
}

static void test_the_strong_pull_up_lasts_until_the_next_call(void)
{
	uint8_t out[10] = {0x55}, in[9];
	const struct link_part part = {
		.reset = true, .out = out, .out_n = 10, .after = LINK_STRONG};

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	memcpy(out + 1, sim_net_slave(&serial.net, "u")->rom, 8);
	out[9] = 0x44;
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->run(serial.wire, &part));
	TEST_ASSERT_TRUE(serial.net.chip[0].wire[0].strong);
	serial.host.now += 800 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(0, serial_scratchpad("u", in));
	TEST_ASSERT_FALSE(serial.net.chip[0].wire[0].strong);
	TEST_ASSERT_EQUAL_UINT64(1, sim_net_slave(&serial.net, "u")->conversions);
	TEST_ASSERT_EQUAL_UINT64(1, sim_net_slave(&serial.net, "u")->power_ons);
}

static void test_a_slot_is_read_and_may_be_followed_by_the_strong_pull_up(void)
{
	uint8_t byte = 0;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	TEST_ASSERT_EQUAL_INT(1, link_slot(serial.wire, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(0, link_slot(serial.wire, false, LINK_STRONG));
	TEST_ASSERT_TRUE(serial.net.chip[0].wire[0].strong);
	TEST_ASSERT_EQUAL_INT(1, link_slot(serial.wire, true, LINK_IDLE));
	TEST_ASSERT_FALSE(serial.net.chip[0].wire[0].strong);
	/* the end of a pull-up is answered, before data too */
	TEST_ASSERT_EQUAL_INT(1, link_slot(serial.wire, true, LINK_STRONG));
	TEST_ASSERT_EQUAL_INT(0, part_read(serial.wire, &byte, 1));
	TEST_ASSERT_EQUAL_HEX8(0xFF, byte);
	TEST_ASSERT_FALSE(serial.net.chip[0].wire[0].strong);
}

static void test_a_strong_pull_up_ends_with_the_port(void)
{
	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	TEST_ASSERT_EQUAL_INT(1, link_slot(serial.wire, true, LINK_STRONG));
	serial.master->ops->close(serial.master);
	TEST_ASSERT_FALSE(serial.net.chip[0].wire[0].strong);
}

/* The command went out, and nobody waits for its answer; nor where the chip is led out after it. */
static void test_a_strong_pull_up_that_was_not_answered_ends_with_the_port(void)
{
	for (unsigned calls = 1; calls <= 2; calls++) {
		serial_start(SIM_DS2480B, &serial_ds2480b, house);
		TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
		serial.host.shutdown = true;
		TEST_ASSERT_EQUAL_INT(-ECANCELED, link_slot(serial.wire, true, LINK_STRONG));
		if (calls == 2)
			TEST_ASSERT_EQUAL_INT(-ECANCELED, part_reset(serial.wire));
		TEST_ASSERT_TRUE(serial.net.chip[0].wire[0].strong);
		serial.master->ops->close(serial.master);
		TEST_ASSERT_FALSE(serial.net.chip[0].wire[0].strong);
		/* a byte takes a ms, and is lost where the port is closed before */
		TEST_ASSERT_GREATER_THAN_INT64(3 * HOST_MS, serial.closed_ns - serial.written_ns);
		tearDown();
		setUp();
	}
}

/* What was to end it never went out, or did so and what followed was lost in the mode for data. */
static void test_a_strong_pull_up_before_a_call_that_fails_ends_with_the_port(void)
{
	uint8_t byte = 0;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	TEST_ASSERT_EQUAL_INT(1, link_slot(serial.wire, true, LINK_STRONG));
	serial.full = true;
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, part_read(serial.wire, &byte, 1));
	serial.full = false;
	serial.master->ops->close(serial.master);
	TEST_ASSERT_FALSE(serial.net.chip[0].wire[0].strong);
	tearDown();
	setUp();
	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	TEST_ASSERT_EQUAL_INT(1, link_slot(serial.wire, true, LINK_STRONG));
	serial.host.shutdown = true;
	TEST_ASSERT_EQUAL_INT(-ECANCELED, part_read(serial.wire, &byte, 1));
	TEST_ASSERT_TRUE(serial.sim.data_mode);
	serial.master->ops->close(serial.master);
	TEST_ASSERT_FALSE(serial.net.chip[0].wire[0].strong);
	TEST_ASSERT_FALSE(serial.sim.data_mode);
}

static void test_a_reset_or_a_bit_that_is_answered_wrong_is_an_error(void)
{
	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	for (unsigned bit = 6; bit < 8; bit++) {
		TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
		serial.sim.answered = 7 + bit;
		serial.sim.noise_each = 1;
		TEST_ASSERT_EQUAL_INT(-EIO, part_reset(serial.wire));
		serial.sim.noise_each = 0;
	}
	for (unsigned bit = 0; bit < 8; bit++) {
		TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
		TEST_ASSERT_EQUAL_INT(1, link_slot(serial.wire, true, LINK_IDLE));
		serial.sim.answered = 7 + bit;
		serial.sim.noise_each = 1;
		TEST_ASSERT_EQUAL_INT(-EIO, link_slot(serial.wire, true, LINK_IDLE));
		serial.sim.noise_each = 0;
	}
}

/* As where the wire is short while it is written: each answer is right, and the byte another. */
static void test_a_byte_before_a_pull_up_that_the_wire_had_otherwise_is_an_error(void)
{
	uint8_t byte = 0x44;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	serial_event("short 0x18 for 20ms");
	TEST_ASSERT_EQUAL_INT(-EIO, part_write(serial.wire, &byte, 1, LINK_STRONG));
}

/* What went before is not known: not a byte goes out, until there is a reset. */
static void test_after_an_error_nothing_goes_on_without_a_reset(void)
{
	uint8_t scratchpad[9], byte = 0, rom[8] = {0}, conflict[8];
	uint64_t sent;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	serial.sim.silent = true;
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, serial_scratchpad("t", scratchpad));
	serial.sim.silent = false;
	sent = serial.sim.bytes;
	TEST_ASSERT_EQUAL_INT(-EIO, part_read(serial.wire, &byte, 1));
	TEST_ASSERT_EQUAL_INT(-EIO, link_slot(serial.wire, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(
		-EIO, serial.wire->ops->path(serial.wire, false, ONEWIRE_SEARCH, rom, conflict));
	TEST_ASSERT_EQUAL_UINT64(sent, serial.sim.bytes);
	serial_check("t");
}

static void lose_an_answer(void)
{
	uint8_t scratchpad[9];

	serial.sim.silent = true;
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, serial_scratchpad("t", scratchpad));
	serial.sim.silent = false;
}

static void test_an_adapter_is_led_out_of_any_mode_and_is_asked_for_its_settings(void)
{
	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	lose_an_answer();
	/* the next byte is the second one of a doubled one */
	serial.sim.data_mode = serial.sim.escaped = true;
	serial_check("t");
	lose_an_answer();
	sim_serial_break(&serial.sim, serial.host.now);
	TEST_ASSERT_EQUAL_INT(-ENXIO, part_reset(serial.wire));
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->recover(serial.wire, LINK_CHIP_RESET));
	serial_check("t");
	/* the first rung leads it out, too */
	TEST_ASSERT_EQUAL_INT(1, part_reset(serial.wire));
	serial.sim.data_mode = true;
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->recover(serial.wire, LINK_BUS_RESET));
	serial_check("t");
}

static void test_an_adapter_in_any_state_is_taken(void)
{
	static const struct {
		uint8_t bytes[4];
		unsigned n, baud;
	} before[] = {{{0xE1}, 1, 9600},       {{0xE1, 0xE3}, 2, 9600}, {{0xB1, 0xE1}, 2, 9600},
	              {{0x3F, 0x93}, 2, 9600}, {{0x77}, 1, 9600},       {{0x77, 0xE1}, 1, 9600}};

	for (unsigned deaf = 0; deaf < 2; deaf++) {
		for (size_t i = 0; i < sizeof(before) / sizeof(before[0]); i++) {
			serial_make(SIM_DS2480B, &serial_ds2480b, house);
			serial.deaf_to_break = deaf;
			for (unsigned k = 0; k < before[i].n; k++)
				sim_serial_send(&serial.sim, before[i].bytes[k], before[i].baud,
				                serial.host.now);
			serial.host.now += HOST_S / 10;
			TEST_ASSERT_EQUAL_INT_MESSAGE(0, serial_try(), serial.why);
			serial_check("t");
			tearDown();
			setUp();
		}
	}
}

static void test_what_answers_in_place_of_a_ds2480b_is_named(void)
{
	serial_make(SIM_DS2480B, &serial_ds2480b, house);
	serial.sim.silent = true;
	TEST_ASSERT_EQUAL_INT(-ENXIO, serial_try());
	TEST_ASSERT_NOT_NULL(strstr(serial.why, "nothing answers on port"));
	serial.sim.silent = false;
	TEST_ASSERT_EQUAL_INT(0, serial_try());
	tearDown();
	setUp();
	serial_make(SIM_PASSIVE, &serial_ds2480b, house);
	TEST_ASSERT_EQUAL_INT(-ENXIO, serial_try());
	TEST_ASSERT_NOT_NULL(strstr(serial.why, "its target is uart:port"));
	TEST_ASSERT_EQUAL_UINT(0, serial.master->ops->channels(serial.master));
}

/* A turned bit of the adapter's answers never becomes a value that the checksum does not know. */
static void test_after_an_answer_that_is_wrong_or_missing_the_next_transaction_is_right(void)
{
	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	for (unsigned turned = 1; turned <= 20; turned++) {
		uint8_t scratchpad[9];

		serial.sim.answered = 0;
		serial.sim.noise_each = turned;
		int err = serial_scratchpad("t", scratchpad);
		serial.sim.noise_each = 0;
		/* the answer to the reset, and the ten bytes that are written, are checked */
		TEST_ASSERT_EQUAL_INT(turned <= 11 ? -EIO : 0, err == -EHOSTDOWN ? -EIO : err);
		serial_check("t");
	}
}

static void test_a_silent_adapter_is_an_error_in_time_and_serves_when_it_is_back(void)
{
	uint8_t scratchpad[9];
	int64_t begun;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	serial.sim.silent = true;
	begun = serial.host.now;
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, serial_scratchpad("t", scratchpad));
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, serial.wire->ops->recover(serial.wire, LINK_BUS_RESET));
	TEST_ASSERT_EQUAL_INT(-ENXIO, serial.wire->ops->recover(serial.wire, LINK_CHIP_RESET));
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP,
	                      serial.wire->ops->recover(serial.wire, LINK_POWER_CYCLE));
	TEST_ASSERT_LESS_THAN_INT64(2 * HOST_S, serial.host.now - begun);
	serial.sim.silent = false;
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->recover(serial.wire, LINK_BUS_RESET));
	serial_check("t");
}

static void test_an_adapter_that_lost_its_supply_is_noticed_before_a_pull_up(void)
{
	uint8_t out[2] = {0xCC, 0x44};
	const struct link_part part = {.reset = true, .out = out, .out_n = 2, .after = LINK_STRONG};

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	sim_serial_break(&serial.sim, serial.host.now);
	serial_check("t");
	TEST_ASSERT_EQUAL_INT(-ENXIO, serial.wire->ops->run(serial.wire, &part));
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->recover(serial.wire, LINK_CHIP_RESET));
	sim_serial_break(&serial.sim, serial.host.now);
	TEST_ASSERT_EQUAL_INT(1, link_slot(serial.wire, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(-ENXIO, link_slot(serial.wire, true, LINK_STRONG));
	TEST_ASSERT_EQUAL_INT(-EIO, link_slot(serial.wire, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->recover(serial.wire, LINK_CHIP_RESET));
	TEST_ASSERT_EQUAL_INT(0, serial.wire->ops->run(serial.wire, &part));
	serial_check("t");
}

static void test_a_port_that_takes_nothing_is_not_waited_for_again(void)
{
	uint8_t scratchpad[9];
	int64_t begun;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	serial.full = true;
	begun = serial.host.now;
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, serial_scratchpad("t", scratchpad));
	TEST_ASSERT_EQUAL_INT64(begun, serial.host.now);
	serial.full = false;
	serial_check("t");
}

static void test_another_program_on_the_port_is_named_without_an_error_too(void)
{
	char proc[] = "/tmp/owsd-serial-XXXXXX", path[64], text[BUS_EVENT_TEXT];
	static const char *const folders[] = {"", "/7", "/7/fd"};
	FILE *f;

	TEST_ASSERT_NOT_NULL(mkdtemp(proc));
	for (unsigned i = 1; i < 3; i++) {
		snprintf(path, sizeof(path), "%s%s", proc, folders[i]);
		TEST_ASSERT_EQUAL_INT(0, mkdir(path, 0755));
	}
	snprintf(path, sizeof(path), "%s/7/comm", proc);
	f = fopen(path, "w");
	TEST_ASSERT_TRUE(f && fputs("digitemp\n", f) >= 0 && !fclose(f));
	serial.proc = proc;
	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	serial.master->ops->trouble(serial.master, false, text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("", text);
	snprintf(path, sizeof(path), "%s/7/fd/3", proc);
	TEST_ASSERT_EQUAL_INT(0, symlink("/dev/null", path));
	serial.master->ops->trouble(serial.master, false, text, sizeof(text));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, "/dev/null is also open in digitemp"), text);
	serial.master->ops->close(serial.master);
	serial.sim.silent = true;
	TEST_ASSERT_EQUAL_INT(-ENXIO, serial_try());
	TEST_ASSERT_EQUAL_PTR_MESSAGE(
		serial.why, strstr(serial.why, "also open in digitemp, process 7: nothing answers"),
		serial.why);
	serial.sim.silent = false;
	TEST_ASSERT_EQUAL_INT(0, serial_try());
	serial.master->ops->trouble(serial.master, false, text, sizeof(text));
	TEST_ASSERT_EQUAL_INT(0, unlink(path));
	/* not each error is worth a look at all processes */
	serial.host.now += 4 * HOST_S;
	serial.master->ops->trouble(serial.master, true, text, sizeof(text));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, "/dev/null is also open in digitemp"), text);
	serial.host.now += HOST_S;
	serial.master->ops->trouble(serial.master, true, text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("", text);
	snprintf(path, sizeof(path), "%s/7/comm", proc);
	TEST_ASSERT_EQUAL_INT(0, unlink(path));
	for (unsigned i = 3; i-- > 0;) {
		snprintf(path, sizeof(path), "%s%s", proc, folders[i]);
		TEST_ASSERT_EQUAL_INT(0, rmdir(path));
	}
}

/* A transaction with a strong pull-up, a reading, and a path of a search. */
static int visit(void)
{
	uint8_t out = 0xCC, in[9];
	const struct link_part part = {
		.reset = true, .out = &out, .out_n = 1, .after = LINK_STRONG};
	struct search search;
	int err = serial.wire->ops->run(serial.wire, &part);

	if (!err)
		err = serial_scratchpad("t", in);
	search_begin(&search, false, 0);
	return err ? err : search_next(&search, serial.wire);
}

static void test_pulled_anywhere_the_adapter_is_gone_and_is_back_when_it_is_plugged_in(void)
{
	int err = -ENODEV;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	for (unsigned n = 1; err; n++) {
		struct link_master_cost before, after;

		serial.master->ops->cost(serial.master, &before);
		serial.pull_at = serial.sim.bytes + n;
		err = visit();
		if (err == 1) {
			TEST_ASSERT_GREATER_THAN_UINT(50, n);
			break;
		}
		TEST_ASSERT_EQUAL_INT(-ENODEV, err);
		serial.master->ops->close(serial.master);
		serial.master->ops->cost(serial.master, &after);
		TEST_ASSERT_GREATER_THAN_UINT64(before.bytes, after.bytes);
		TEST_ASSERT_EQUAL_INT(-ENODEV, part_reset(serial.wire));
		TEST_ASSERT_EQUAL_INT(-ENODEV,
		                      serial.wire->ops->recover(serial.wire, LINK_BUS_RESET));
		serial.pulled = false;
		serial.pull_at = 0;
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, serial_try(), serial.why);
		serial_check("t");
	}
}

static void test_a_shutdown_ends_every_wait(void)
{
	uint8_t in[9];

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	serial.host.shutdown = true;
	TEST_ASSERT_EQUAL_INT(-ECANCELED, serial_scratchpad("t", in));
	TEST_ASSERT_EQUAL_INT(-ECANCELED, serial_try());
}

static void test_what_a_transaction_costs_is_counted(void)
{
	struct link_cost before, after;
	struct link_master_cost shared;

	serial_start(SIM_DS2480B, &serial_ds2480b, house);
	serial.wire->ops->cost(serial.wire, &before);
	serial_check("t");
	serial.wire->ops->cost(serial.wire, &after);
	TEST_ASSERT_EQUAL_UINT64(1, after.resets - before.resets);
	TEST_ASSERT_EQUAL_UINT64(1096000 + 19 * 8 * 69400, after.wire_ns - before.wire_ns);
	serial.master->ops->cost(serial.master, &shared);
	TEST_ASSERT_GREATER_THAN_UINT64(20, shared.bytes);
	TEST_ASSERT_GREATER_THAN_UINT64(0, shared.transfers);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_reading_is_one_write_and_one_read_and_takes_the_time_of_its_bytes);
	RUN_TEST(test_the_chip_is_set_up_for_long_lines_and_kept_at_flexible_speed);
	RUN_TEST(test_a_chip_is_reset_by_break_and_slow_byte_and_gets_its_time_base);
	RUN_TEST(test_settings_that_do_not_come_back_are_an_error);
	RUN_TEST(test_a_port_that_never_falls_silent_is_given_up);
	RUN_TEST(test_bytes_that_are_commands_reach_the_wire_as_data);
	RUN_TEST(test_a_long_transaction_goes_in_pieces);
	RUN_TEST(test_a_short_and_nobody_are_told_apart);
	RUN_TEST(test_the_accelerator_finds_all_devices_of_a_family_of_an_alarm_or_none);
	RUN_TEST(test_a_search_for_one_id_says_whether_it_is_there_and_leaves_it_selected);
	RUN_TEST(test_a_path_that_breaks_off_turns_the_accelerator_off_and_is_an_error);
	RUN_TEST(test_the_strong_pull_up_lasts_until_the_next_call);
	RUN_TEST(test_a_slot_is_read_and_may_be_followed_by_the_strong_pull_up);
	RUN_TEST(test_a_strong_pull_up_ends_with_the_port);
	RUN_TEST(test_a_strong_pull_up_that_was_not_answered_ends_with_the_port);
	RUN_TEST(test_a_strong_pull_up_before_a_call_that_fails_ends_with_the_port);
	RUN_TEST(test_a_reset_or_a_bit_that_is_answered_wrong_is_an_error);
	RUN_TEST(test_a_byte_before_a_pull_up_that_the_wire_had_otherwise_is_an_error);
	RUN_TEST(test_after_an_error_nothing_goes_on_without_a_reset);
	RUN_TEST(test_an_adapter_is_led_out_of_any_mode_and_is_asked_for_its_settings);
	RUN_TEST(test_an_adapter_in_any_state_is_taken);
	RUN_TEST(test_what_answers_in_place_of_a_ds2480b_is_named);
	RUN_TEST(test_after_an_answer_that_is_wrong_or_missing_the_next_transaction_is_right);
	RUN_TEST(test_a_silent_adapter_is_an_error_in_time_and_serves_when_it_is_back);
	RUN_TEST(test_an_adapter_that_lost_its_supply_is_noticed_before_a_pull_up);
	RUN_TEST(test_a_port_that_takes_nothing_is_not_waited_for_again);
	RUN_TEST(test_another_program_on_the_port_is_named_without_an_error_too);
	RUN_TEST(test_pulled_anywhere_the_adapter_is_gone_and_is_back_when_it_is_plugged_in);
	RUN_TEST(test_a_shutdown_ends_every_wait);
	RUN_TEST(test_what_a_transaction_costs_is_counted);
	return UNITY_END();
}
