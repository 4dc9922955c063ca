/* SPDX-License-Identifier: MIT */
/* The target w1:netlink: devices, values, alarms. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/native/state.h"
#include "hal/netlink/talk.h"
#include "unity.h"

#include "hal/owfs/path.h"
#include "hal/sim/chips/tmp1826.h"
#include "tests/unit/aid/netlink_scene.h"

void setUp(void)
{
	nl_begin();
}

void tearDown(void)
{
	nl_end();
}

static void test_devices_of_all_masters_are_found_and_read(void)
{
	nl_masters(2);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625),
			 *cold = nl_thermometer(1, 2, -10.125);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	nl_reads(cold, "temperature12", "     -10.125");
	TEST_ASSERT_EQUAL_UINT(2, host_events(&nl.host, BUS_FOUND));
}

static void test_one_master_can_be_named(void)
{
	nl_masters(3);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625),
			 *cold = nl_thermometer(1, 2, -10.125);
	nl_create("/w1_bus_master2");
	nl_reads(cold, "temperature12", "     -10.125");
	TEST_ASSERT_EQUAL_INT(-ENODEV, nl_read(warm, "temperature"));
}

static void test_a_transaction_is_one_request(void)
{
	nl_masters(1);
	struct sim_slave *slave = nl_thermometer(0, 1, 21.0625);
	nl_start();
	nl_reads(slave, "temperature", "     21.0625");
	unsigned before = w1_core.requests;
	nl_reads(slave, "scratchpad", (char *)nl.data);
	TEST_ASSERT_EQUAL_UINT(before + 1, w1_core.requests);
}

struct kept {
	char path[100], text[200];
	int err;
};
static struct kept kept[1000];
static unsigned kept_count;

static bool differs_by_time(const char *path)
{
	return strstr(path, "date") || strstr(path, "pages/page") || strstr(path, "DS2438");
}

static void read_all(const char *directory)
{
	char list[NETLINK_ROOM];

	if (nl_ask(BUS_DIR, directory, NULL)->err)
		return;
	memcpy(list, nl.data, sizeof(list));
	for (char *line = strtok(list, "\n"); line; line = strtok(NULL, "\n")) {
		TEST_ASSERT_LESS_THAN_UINT(sizeof(kept) / sizeof(kept[0]), kept_count);
		snprintf(kept[kept_count++].path, sizeof(kept->path), "%s", line);
	}
	for (unsigned i = 0; i < kept_count; i++) {
		kept[i].err = nl_ask(BUS_READ, kept[i].path, NULL)->err;
		memcpy(kept[i].text, nl.data, sizeof(kept->text));
	}
}

static struct sim_slave *chip(const char *name)
{
	nl_thermometer(0, 1, 20);
	return wire_add(0, name, 7);
}

/* Without a supply of its own it needs the strong pull-up. */
static void power(const struct sim_slave *slave)
{
	if (slave->rom[0] == 0x20)
		TEST_ASSERT_EQUAL_INT(0, nl_write(slave, "power", "1"));
}

/* A TMP1826's memory needs pauses between the bytes, which the kernel's messages have not. */
static int expected(const struct kept *of)
{
	return strncmp(of->path, "/26.", 4) == 0 && strstr(of->path, "memory") ? -EOPNOTSUPP
	                                                                       : of->err;
}

static void compare_family(const char *name)
{
	kept_count = 0;
	struct sim_slave *slave = chip(name);
	nl.bus = wire_open();
	power(slave);
	read_all(nl_path(slave, ""));
	nl_close();
	wire_clear();
	slave = chip(name);
	nl.host.events = 0;
	nl_start();
	power(slave);
	for (unsigned i = 0; i < kept_count; i++) {
		const struct bus_answer *answer = nl_ask(BUS_READ, kept[i].path, NULL);

		TEST_ASSERT_EQUAL_INT_MESSAGE(expected(&kept[i]), answer->err, kept[i].path);
		if (!answer->err && !differs_by_time(kept[i].path))
			TEST_ASSERT_EQUAL_MEMORY_MESSAGE(kept[i].text, nl.data, sizeof(kept->text),
			                                 kept[i].path);
	}
	nl_close();
	wire_clear();
}

static void test_every_family_reads_as_over_a_wire_while_others_use_the_master(void)
{
	unsigned families = 0, properties = 0;

	nl_masters(1);
	w1_core.intrudes = true;
	for (const struct sim_family *const *family = sim_families; *family; family++, families++) {
		host_init_virtual(&nl.host);
		wire_init(&nl.host, 1, 1);
		w1_core_stop();
		w1_core_start(&nl.host, 1);
		w1_core.intrudes = true;
		compare_family((*family)->name);
		properties += kept_count;
	}
	TEST_ASSERT_GREATER_THAN_UINT(10, families);
	TEST_ASSERT_GREATER_THAN_UINT(200, properties);
}

static void test_replies_may_come_one_by_one(void)
{
	nl_masters(1);
	w1_core.spreads = true;
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625);
	for (unsigned i = 2; i < 8; i++)
		nl_thermometer(0, i, i);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	TEST_ASSERT_EQUAL_UINT(7, host_events(&nl.host, BUS_FOUND));
}

/* --- Writing --- */

static void test_outputs_and_settings_reach_their_chips(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 20), *board = wire_add(0, "DS2408", 2),
			 *gate = wire_add(0, "DS2413", 3), *pair = wire_add(0, "DS2406", 4),
			 *lamp = wire_add(0, "DS2405", 5), *store = wire_add(0, "DS2431", 6);
	w1_core.intrudes = true;
	nl_start();
	TEST_ASSERT_EQUAL_INT(0, nl_write(warm, "templow", "-5"));
	nl_reads(warm, "templow", "          -5");
	TEST_ASSERT_EQUAL_INT(0, nl_write(board, "PIO.BYTE", "165"));
	nl_reads(board, "PIO.BYTE", "         165");
	TEST_ASSERT_EQUAL_INT(0, nl_write(gate, "PIO.ALL", "1,0"));
	nl_reads(gate, "PIO.ALL", "1,0");
	TEST_ASSERT_EQUAL_INT(0, nl_write(pair, "PIO.ALL", "0,1"));
	nl_reads(pair, "PIO.ALL", "0,1");
	TEST_ASSERT_EQUAL_INT(0, nl_write(lamp, "PIO", "1"));
	nl_reads(lamp, "PIO", "1");
	nl_reads(lamp, "sensed", "0");
	TEST_ASSERT_EQUAL_INT(0, nl_write(lamp, "PIO", "0"));
	nl_reads(lamp, "PIO", "0");
	TEST_ASSERT_EQUAL_INT(0, nl_write(store, "pages/page.1", "kept"));
	TEST_ASSERT_EQUAL_INT(0, nl_read(store, "pages/page.1"));
	TEST_ASSERT_EQUAL_MEMORY("kept", nl.data, 4);
}

static void test_a_display_takes_its_bytes_one_by_one(void)
{
	nl_masters(1);
	struct sim_slave *board = wire_add(0, "DS2408", 2);
	w1_core.intrudes = true;
	nl_start();
	TEST_ASSERT_EQUAL_INT(0, nl_write(board, "LCD_H/message", "hello"));
}

static void test_thermometers_fed_by_the_wire_are_refused_and_others_not(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625), *cold = nl_thermometer(0, 2, -10);
	cold->parasite = true;
	nl_start();
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, nl_read(cold, "temperature"));
	nl_reads(warm, "temperature", "     21.0625");
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, nl_write(cold, "templow", "3"));
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP,
	                      nl_ask(BUS_WRITE, "/simultaneous/temperature", "1")->err);
	TEST_ASSERT_EQUAL_INT(0, nl_write(warm, "templow", "3"));
	TEST_ASSERT_EQUAL_UINT64(0, cold->conversions);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&nl.host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT64(0, ((struct native *)nl.bus)->count[COUNT_LINK_ERRORS]);
}

static void test_a_converter_without_supply_is_refused(void)
{
	nl_masters(1);
	struct sim_slave *slave = wire_add(0, "DS2450", 1);
	nl_start();
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, nl_read(slave, "volt.A"));
	TEST_ASSERT_EQUAL_INT(0, nl_write(slave, "power", "1"));
	TEST_ASSERT_EQUAL_INT(0, nl_read(slave, "volt.A"));
	TEST_ASSERT_EQUAL_UINT64(0, ((struct native *)nl.bus)->count[COUNT_LINK_ERRORS]);
}

/* --- Alarms --- */

/*
 * The EEPROM of a TMP1826 needs a pause within a transaction, and the kernel makes a transaction
 * without one. Neither a value nor a write that is made of false bytes comes of that.
 */
static void test_an_eeprom_that_needs_a_pause_is_refused(void)
{
	uint8_t before[SIM_TMP1826_MEMORY];

	nl_masters(1);
	struct sim_slave *slave = wire_add(0, "TMP1826", 1);
	struct sim_tmp1826 *state = slave->state;

	for (unsigned i = 0; i < sizeof(before); i++)
		state->memory[i] = before[i] = (uint8_t)(i * 7 + 3);
	nl_start();
	for (unsigned known = 0; known < 2; known++) {
		TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, nl_read(slave, "memory"));
		TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, nl_write(slave, "memory", "ABC"));
		TEST_ASSERT_EQUAL_HEX8_ARRAY(before, state->memory, sizeof(before));
		wire_set(slave, "temperature", 21.5);
		nl_reads(slave, "temperature", "        21.5");
	}
}

static void test_nobody_in_alarm_costs_one_short_request(void)
{
	nl_masters(1);
	for (unsigned i = 1; i < 10; i++)
		wire_add(0, "DS2405", i);
	nl_start();
	host_run(&nl.host, nl.bus, nl.host.now + HOST_S);
	unsigned before = w1_core.requests;
	nl_lists("/alarm", "");
	TEST_ASSERT_EQUAL_UINT(before + 1, w1_core.requests);
	TEST_ASSERT_EQUAL_UINT(0, w1_core.alarm_searches);
}

static void test_random_alarms_are_all_found(void)
{
	struct sim_slave *slave[40];
	unsigned seed = 20260101;

	nl_masters(1);
	w1_core.intrudes = true;
	/* The intruder's: a DS2405 would be switched by it. */
	nl_thermometer(0, 9999, 20);
	for (unsigned i = 0; i < 40; i++)
		slave[i] = wire_add(0, i % 4 ? "DS18B20" : "DS2405", i * 77 + 1);
	nl_start();
	host_run(&nl.host, nl.bus, nl.host.now + HOST_S);
	for (int round = 0; round < 20; round++) {
		char name[100];
		bool wanted[40] = {false};

		for (unsigned i = 0; i < 40; i += 4) {
			seed = seed * 1103515245 + 12345;
			wanted[i] = seed >> 16 & 1;
			TEST_ASSERT_EQUAL_INT(0, nl_write(slave[i], "PIO", wanted[i] ? "1" : "0"));
		}
		TEST_ASSERT_EQUAL_INT(
			0, nl_ask(BUS_DIR, round & 1 ? "/alarm" : "/alarm/05,29", NULL)->err);
		for (unsigned i = 0; i < 40; i++) {
			rom_print(slave[i]->rom, ROM_F_I, name);
			if (strstr((char *)nl.data, name))
				TEST_ASSERT_TRUE_MESSAGE(wanted[i], name);
			else
				TEST_ASSERT_FALSE_MESSAGE(wanted[i], name);
		}
	}
}

static void test_an_unknown_device_in_alarm_is_found_and_read(void)
{
	nl_masters(1);
	nl_thermometer(0, 1, 20);
	nl_start();
	host_run(&nl.host, nl.bus, nl.host.now + HOST_S);
	struct sim_slave *board = wire_add(0, "DS2408", 9);
	char expected[100], name[ROM_TEXT_MAX];
	rom_print(board->rom, ROM_F_I, name);
	snprintf(expected, sizeof(expected), "/alarm/%s\n", name);
	nl_lists("/alarm", expected);
}

/* So often that each search in a row is made, whole and not. */
#define SEARCHES 40

static void list_alarms(const char *where, const char *list)
{
	for (unsigned i = 0; i < SEARCHES; i++)
		nl_lists(where, list);
}

/* A thermometer at 20 degrees, with limits that it keeps. */
static struct sim_slave *calm(unsigned id)
{
	return nl_thermometer(0, id, 20);
}

static void convert_all(const struct sim_slave *slave)
{
	TEST_ASSERT_EQUAL_INT(0, nl_write(slave, "temphigh", "30"));
	TEST_ASSERT_EQUAL_INT(0, nl_write(slave, "templow", "10"));
	nl_reads(slave, "temperature", "          20");
}

/* To be in the search is their alarm: no other chip makes it. */
static void test_no_thermometer_is_in_alarm_for_one_that_is_new(void)
{
	for (unsigned id = 2; id < 6; id++) {
		char list[100], name[ROM_TEXT_MAX];

		nl_masters(1);
		struct sim_slave *old = calm(1);
		nl_start();
		convert_all(old);
		struct sim_slave *new = nl_thermometer(0, id << 8 | 1, 90);
		rom_print(new->rom, ROM_F_I, name);
		TEST_ASSERT_EQUAL_INT(0, nl_ask(BUS_WRITE, "/simultaneous/temperature", "1")->err);
		host_run(&nl.host, nl.bus, nl.host.now + 800 * HOST_MS);
		snprintf(list, sizeof(list), "/alarm/%s\n", name);
		list_alarms(id & 1 ? "/alarm" : "/alarm/28", list);
		tearDown();
		setUp();
	}
}

/* Of a switch the latch tells, unless the list has to. */
static void test_no_switch_is_listed_for_a_new_one_where_its_id_is_read_whole(void)
{
	char list[100], name[ROM_TEXT_MAX];

	nl_masters(1);
	struct sim_slave *old = wire_add(0, "DS2408", 1);
	nl_start();
	TEST_ASSERT_EQUAL_INT(0, nl_write(old, "por", "0"));
	TEST_ASSERT_EQUAL_INT(0, nl_write(old, "latch.BYTE", "0"));
	struct sim_slave *new = wire_add(0, "DS2408", 0x201);
	rom_print(new->rom, ROM_F_I, name);
	snprintf(list, sizeof(list), "/alarm/%s\n", name);
	nl.whole = true;
	list_alarms("/alarm/29", list);
}

/* One turned slot neither makes an alarm nor ends one. */
static void test_no_turned_slot_changes_who_is_in_alarm(void)
{
	static struct trouble trouble;
	char list[100], name[ROM_TEXT_MAX];

	nl_masters(1);
	wire_net.trouble = &trouble;
	trouble_none(&trouble);
	struct sim_slave *slave = calm(1);
	nl_start();
	convert_all(slave);
	rom_print(slave->rom, ROM_F_I, name);
	for (unsigned hot = 0; hot < 2; hot++) {
		if (hot)
			TEST_ASSERT_EQUAL_INT(0, nl_write(slave, "temphigh", "15"));
		nl_reads(slave, "temperature", "          20");
		snprintf(list, sizeof(list), "/alarm/%s\n", name);
		for (uint32_t at = 8; at < 8 + 3 * 64; at++) {
			trouble_none(&trouble);
			trouble.kind = TROUBLE_TURN;
			trouble.at = at;
			trouble.mask = 1;
			nl_lists("/alarm/28", hot ? list : "");
		}
		trouble_none(&trouble);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_devices_of_all_masters_are_found_and_read);
	RUN_TEST(test_one_master_can_be_named);
	RUN_TEST(test_a_transaction_is_one_request);
	RUN_TEST(test_every_family_reads_as_over_a_wire_while_others_use_the_master);
	RUN_TEST(test_replies_may_come_one_by_one);
	RUN_TEST(test_outputs_and_settings_reach_their_chips);
	RUN_TEST(test_a_display_takes_its_bytes_one_by_one);
	RUN_TEST(test_thermometers_fed_by_the_wire_are_refused_and_others_not);
	RUN_TEST(test_a_converter_without_supply_is_refused);
	RUN_TEST(test_an_eeprom_that_needs_a_pause_is_refused);
	RUN_TEST(test_nobody_in_alarm_costs_one_short_request);
	RUN_TEST(test_random_alarms_are_all_found);
	RUN_TEST(test_an_unknown_device_in_alarm_is_found_and_read);
	RUN_TEST(test_no_thermometer_is_in_alarm_for_one_that_is_new);
	RUN_TEST(test_no_switch_is_listed_for_a_new_one_where_its_id_is_read_whole);
	RUN_TEST(test_no_turned_slot_changes_who_is_in_alarm);
	return UNITY_END();
}
