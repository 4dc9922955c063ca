/* SPDX-License-Identifier: MIT */
/* Tests of thermometers over the kernel's 1-Wire drivers. */
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "hal/native/state.h"
#include "unity.h"

#include "hal/chips/area.h"
#include "hal/native/native.h"
#include "hal/owfs/path.h"
#include "hal/w1/state.h"
#include "hal/wire/driver.h"
#include "tests/unit/aid/fs_scene.h"

void setUp(void)
{
	fs_begin();
}

void tearDown(void)
{
	fs_end();
}

static void test_a_thermometer_reads_as_elsewhere(void)
{
	fs_thermometer(WARM, 0x151);
	fs_start();
	fs_reads("     21.0625", WARM_OW "/temperature");
	fs_reads("     21.0625", WARM_OW "/temperature12");
	fs_reads("     21.0625", WARM_OW "/latesttemp");
	fs_reads("          75", WARM_OW "/temphigh");
	fs_reads("          70", WARM_OW "/templow");
	fs_reads("          12", WARM_OW "/tempres");
	fs_reads("1", WARM_OW "/power");
	fs_reads("1", WARM_OW "/present");
	fs_reads("DS18B20", WARM_OW "/type");
	fs_fails(-ENOENT, WARM_OW "/errata/trim");
	fs_fails(-ENOENT, WARM_OW "/volt");
}

static void test_below_zero_too(void)
{
	fs_thermometer(WARM, (uint16_t)-162);
	fs_start();
	fs_reads("     -10.125", WARM_OW "/temperature");
}

static void test_the_value_alone_is_brought_back_to_sixteenths(void)
{
	fs_slave(WARM);
	fs_text(WARM, "temperature", "21062\n");
	fs_slave("10-0000000000c1");
	fs_text("10-0000000000c1", "temperature", "25375\n");
	fs_start();
	fs_reads("     21.0625", WARM_OW "/temperature");
	fs_reads("      25.375", "/10.C10000000000/temperature");
	fs_text(WARM, "temperature", "-10125\n");
	fs_text("10-0000000000c1", "temperature", "-7312\n");
	fs_reads("     -10.125", WARM_OW "/temperature");
	fs_reads("     -7.3125", "/10.C10000000000/temperature");
}

static void test_a_number_that_no_chip_can_have_is_a_failed_reading(void)
{
	fs_slave(WARM);
	fs_text(WARM, "temperature", "99999999999999999999\n");
	fs_start();
	fs_fails(-EIO, WARM_OW "/temperature");
	fs_text(WARM, "temperature", "-2147483648\n");
	fs_fails(-EIO, WARM_OW "/temperature");
	fs_text(WARM, "temperature", "21062\n");
	fs_text(WARM, "alarms", "-10 700\n");
	fs_fails(-EIO, WARM_OW "/temphigh");
	fs_text(WARM, "alarms", "-10\n");
	fs_fails(-EIO, WARM_OW "/templow");
	fs_text(WARM, "alarms", "-10 70\n");
	fs_reads("         -10", WARM_OW "/templow");
}

static void test_an_empty_file_is_a_failed_reading(void)
{
	fs_thermometer(WARM, 0x151);
	fs_start();
	fs_text(WARM, "w1_slave", "");
	fs_fails(-EIO, WARM_OW "/temperature");
	fs_broken(WARM, "w1_slave");
	fs_fails(-EIO, WARM_OW "/temperature");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&fs.host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&fs.host, BUS_LOST));
}

static void test_a_wrong_checksum_is_told(void)
{
	fs_thermometer(WARM, 0x151);
	fs_start();
	fs_scratchpad(WARM, 0x151, 75, 70, 0x7f, "NO");
	fs_fails(-EBADMSG, WARM_OW "/temperature");
	fs_text(WARM, "w1_slave", "garbage\n");
	fs_fails(-EIO, WARM_OW "/temperature");
}

/* The formula of the kernel, with the register of a DS1820 of the 1990s; 16 in later chips. */
static void test_the_counts_of_a_degree_are_those_of_the_chip(void)
{
	fs_slave("10-0000000000c1");
	fs_text("10-0000000000c1", "w1_slave",
	        "32 00 ff ff ff ff 2a 4e a3 : crc=a3 YES\n"
	        "32 00 ff ff ff ff 2a 4e a3 t=25211\n");
	fs_start();
	fs_reads("     25.2115", "/10.C10000000000/temperature");
}

/* What a wire gives without a chip has a right checksum, too. */
static void test_an_answer_of_ones_or_zeros_is_called_so(void)
{
	static const char *const lines[] = {
		"00 00 00 00 00 00 00 00 00 : crc=00 YES\n",
		"ff ff ff ff ff ff ff ff c9 : crc=c9 YES\n",
	};

	fs_slave("10-0000000000c1");
	fs_thermometer(WARM, 0x151);
	fs_start();
	for (unsigned i = 0; i < 2; i++) {
		fs_text("10-0000000000c1", "w1_slave", lines[i]);
		fs_text(WARM, "w1_slave", lines[i]);
		fs_fails(-ENOMSG, "/10.C10000000000/temperature");
		fs_fails(-ENOMSG, WARM_OW "/temperature");
	}
	/* Neither ones nor zeros, but no degree is divided in none. */
	fs_text("10-0000000000c1", "w1_slave", "32 00 4b 46 ff ff 0c 00 f6 : crc=f6 YES\n");
	fs_fails(-EBADE, "/10.C10000000000/temperature");
}

static int scratchpad(struct link *link, uint8_t pad[9])
{
	static const struct area area = {.name = "scratchpad", .size = 9};
	static const uint8_t rom[8] = {0x28, 0xa1};

	return pad ? link->driver->area_read(link, rom, &area, 0, pad, 9)
	           : link->driver->convert(link, rom, "temperature");
}

/* Whoever asks again, and not for a conversion, gets none of the values before it. */
static void test_a_reading_that_failed_is_not_made_up_by_the_one_before(void)
{
	uint8_t pad[9];

	fs_thermometer(WARM, 0x151);
	fs_start();
	struct link *link = &((struct w1_master *)((struct native *)fs.bus)->master)->links[0].link;
	TEST_ASSERT_EQUAL_INT(0, scratchpad(link, NULL));
	TEST_ASSERT_EQUAL_INT(0, scratchpad(link, pad));
	TEST_ASSERT_EQUAL_HEX8(0x51, pad[0]);
	TEST_ASSERT_EQUAL_INT(0, scratchpad(link, NULL));
	fs_text(WARM, "w1_slave", "");
	TEST_ASSERT_EQUAL_INT(-EIO, scratchpad(link, pad));
	TEST_ASSERT_EQUAL_INT(-EIO, scratchpad(link, pad));
	fs_scratchpad(WARM, 0x161, 75, 70, 0x7f, "YES");
	TEST_ASSERT_EQUAL_INT(0, scratchpad(link, pad));
	TEST_ASSERT_EQUAL_HEX8(0x61, pad[0]);
}

static void test_power_faults_are_never_good(void)
{
	fs_thermometer(WARM, 0x550);
	fs_start();
	fs_fails(-ERANGE, WARM_OW "/temperature");
	fs_scratchpad(WARM, 0x7ff, 75, 70, 0x7f, "YES");
	fs_fails(-ERANGE, WARM_OW "/temperature");
	fs_scratchpad(WARM, 0x551, 75, 70, 0x7f, "YES");
	fs_reads("     85.0625", WARM_OW "/temperature");
}

static void test_a_resolution_is_written_when_it_differs(void)
{
	fs_thermometer(WARM, 0x151);
	fs_start();
	fs_reads("     21.0625", WARM_OW "/temperature12");
	TEST_ASSERT_EQUAL_STRING("12\n", fs_now_in(WARM, "resolution"));
	fs_scratchpad(WARM, 0x150, 75, 70, 0x1f, "YES");
	fs_reads("          21", WARM_OW "/temperature9");
	TEST_ASSERT_EQUAL_STRING_LEN("9\n", fs_now_in(WARM, "resolution"), 2);
}

static void test_limits_are_written_and_saved(void)
{
	fs_thermometer(WARM, 0x151);
	fs_text(WARM, "eeprom_cmd", "");
	fs_start();
	TEST_ASSERT_EQUAL_INT(0, fs_writes(WARM_OW "/temphigh", "30"));
	TEST_ASSERT_EQUAL_STRING("70 30\n", fs_now_in(WARM, "alarms"));
	TEST_ASSERT_EQUAL_STRING("save\n", fs_now_in(WARM, "eeprom_cmd"));
	fs_reads("          30", WARM_OW "/temphigh");
	TEST_ASSERT_EQUAL_INT(-EINVAL, fs_writes(WARM_OW "/temphigh", "300"));
}

static uint64_t conversions(void)
{
	size_t n;
	const struct bus_counter *counters = bus_counters(fs.bus, &n);

	for (size_t i = 0; i < n; i++)
		if (strcmp(counters[i].name, "conversions") == 0)
			return bus_counted(&counters[i]);
	TEST_FAIL_MESSAGE("no counter of conversions");
	return 0;
}

static void test_all_that_are_due_convert_at_once(void)
{
	uint32_t ids[3];

	fs_thermometer(WARM, 0x151);
	fs_thermometer("28-0000000000a2", 0x10);
	fs_thermometer("28-0000000000a3", 0x20);
	fs_text("w1_bus_master1", "therm_bulk_read", "0\n");
	fs_start();
	ids[0] = fs_ask(BUS_READ, WARM_OW "/temperature", NULL, 0);
	ids[1] = fs_ask(BUS_READ, "/28.A20000000000/temperature", NULL, 0);
	ids[2] = fs_ask(BUS_READ, "/28.A30000000000/temperature", NULL, 0);
	for (int i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL_INT(0, fs_result(ids[i]));
	TEST_ASSERT_EQUAL_STRING("trigger\n", fs_now_in("w1_bus_master1", "therm_bulk_read"));
	TEST_ASSERT_EQUAL_STRING("           2", (char *)fs.data[ids[2]]);
	TEST_ASSERT_EQUAL_UINT64(1, conversions());
}

/* One that converts by itself would keep the thread waiting for as long as that takes. */
static void test_those_asked_for_without_pause_convert_at_once(void)
{
	static const char *const paths[] = {WARM_OW "/temperature", "/28.A20000000000/temperature",
	                                    "/28.A30000000000/temperature",
	                                    "/28.A40000000000/temperature"};
	unsigned of[FS_REQUESTS], taken = 0;

	fs_thermometer(WARM, 0x151);
	fs_thermometer("28-0000000000a2", 0x10);
	fs_thermometer("28-0000000000a3", 0x20);
	fs_thermometer("28-0000000000a4", 0x30);
	fs_text("w1_bus_master1", "therm_bulk_read", "0\n");
	fs_start();
	for (unsigned i = 0; i < 4; i++)
		of[fs_ask(BUS_READ, paths[i], NULL, 0)] = i;
	while (taken < 40) {
		TEST_ASSERT_TRUE(
			host_run_answers(&fs.host, fs.bus, taken + 1, fs.host.now + 5 * HOST_S));
		for (; taken < fs.host.answers; taken++) {
			unsigned i = of[fs.host.answer[taken].id];

			TEST_ASSERT_EQUAL_INT(0, fs.host.answer[taken].err);
			of[fs_ask(BUS_READ, paths[i], NULL, 0)] = i;
		}
	}
	TEST_ASSERT_LESS_OR_EQUAL_UINT64(12, conversions());
}

static void test_a_refusal_to_convert_all_at_once_is_remembered(void)
{
	fs_thermometer(WARM, 0x151);
	fs_text("w1_bus_master1", "therm_bulk_read", "0\n");
	fs_broken("w1_bus_master1", "therm_bulk_read");
	fs_start();
	fs_reads("     21.0625", WARM_OW "/temperature");
	fs_erase("w1_bus_master1/therm_bulk_read");
	fs_text("w1_bus_master1", "therm_bulk_read", "0\n");
	fs_reads("     21.0625", WARM_OW "/temperature");
	TEST_ASSERT_EQUAL_STRING("0\n", fs_now_in("w1_bus_master1", "therm_bulk_read"));
	host_run(&fs.host, fs.bus, fs.host.now + 61 * HOST_S);
	fs_reads("     21.0625", WARM_OW "/temperature");
	TEST_ASSERT_EQUAL_STRING("trigger\n", fs_now_in("w1_bus_master1", "therm_bulk_read"));
}

static bool triggered(void)
{
	bool yes = strcmp(fs_now_in("w1_bus_master1", "therm_bulk_read"), "trigger\n") == 0;

	fs_text("w1_bus_master1", "therm_bulk_read", "0\n");
	return yes;
}

/* The driver of 6.1 dies of a slave of another kind that is attached meanwhile. */
static void test_all_convert_at_once_only_where_nothing_else_can_come(void)
{
	fs_thermometer(WARM, 0x151);
	fs_text("w1_bus_master1", "therm_bulk_read", "0\n");
	fs_text("w1_bus_master1", "w1_master_search", "-1\n");
	fs_text("w1_bus_master1", "w1_master_attempts", "1\n");
	fs_start();
	fs_reads("     21.0625", WARM_OW "/temperature");
	TEST_ASSERT_FALSE(triggered());
	fs_text("w1_bus_master1", "w1_master_attempts", "2\n");
	fs_reads("     21.0625", WARM_OW "/temperature");
	TEST_ASSERT_TRUE(triggered());
	fs_slave("12-0000000000e1");
	host_run(&fs.host, fs.bus, fs.host.now + 12 * HOST_S);
	fs_reads("     21.0625", WARM_OW "/temperature");
	TEST_ASSERT_FALSE(triggered());
}

/* The driver feeds those that have no supply of their own. */
static void test_one_that_the_wire_feeds_converts_with_the_others(void)
{
	fs_thermometer(WARM, 0x151);
	fs_thermometer("28-0000000000a2", 0x10);
	fs_thermometer("28-0000000000a3", 0x20);
	fs_text("28-0000000000a3", "ext_power", "0\n");
	fs_text("w1_bus_master1", "therm_bulk_read", "0\n");
	fs_start();
	fs_reads("0", "/28.A30000000000/power");
	fs_reads("1", WARM_OW "/power");
	uint32_t one = fs_ask(BUS_READ, WARM_OW "/temperature", NULL, 0);
	uint32_t two = fs_ask(BUS_READ, "/28.A20000000000/temperature", NULL, 0);
	TEST_ASSERT_EQUAL_INT(0, fs_result(one));
	TEST_ASSERT_EQUAL_INT(0, fs_result(two));
	TEST_ASSERT_EQUAL_STRING("trigger\n", fs_now_in("w1_bus_master1", "therm_bulk_read"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_thermometer_reads_as_elsewhere);
	RUN_TEST(test_below_zero_too);
	RUN_TEST(test_the_value_alone_is_brought_back_to_sixteenths);
	RUN_TEST(test_a_number_that_no_chip_can_have_is_a_failed_reading);
	RUN_TEST(test_an_empty_file_is_a_failed_reading);
	RUN_TEST(test_a_wrong_checksum_is_told);
	RUN_TEST(test_the_counts_of_a_degree_are_those_of_the_chip);
	RUN_TEST(test_an_answer_of_ones_or_zeros_is_called_so);
	RUN_TEST(test_a_reading_that_failed_is_not_made_up_by_the_one_before);
	RUN_TEST(test_power_faults_are_never_good);
	RUN_TEST(test_a_resolution_is_written_when_it_differs);
	RUN_TEST(test_limits_are_written_and_saved);
	RUN_TEST(test_all_that_are_due_convert_at_once);
	RUN_TEST(test_those_asked_for_without_pause_convert_at_once);
	RUN_TEST(test_a_refusal_to_convert_all_at_once_is_remembered);
	RUN_TEST(test_all_convert_at_once_only_where_nothing_else_can_come);
	RUN_TEST(test_one_that_the_wire_feeds_converts_with_the_others);
	return UNITY_END();
}
