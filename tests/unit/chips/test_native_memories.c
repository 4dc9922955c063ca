/* SPDX-License-Identifier: MIT */
/* The families of memories, clocks and the potentiometer, on the native bus. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

static struct sim_slave *chip;

void setUp(void)
{
}

void tearDown(void)
{
	if (bus)
		native_end();
}

static void begin(const char *part)
{
	native_begin();
	wire_init(&host, 1, 1);
	chip = wire_add(0, part, 1);
	start();
}

static void end(void)
{
	native_end();
}

static void put(const char *property, const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, result(BUS_WRITE, of(chip, property), text), property);
}

static void refuses(const char *property, const char *text, int err)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, result(BUS_WRITE, of(chip, property), text), property);
}

static void expects(const char *property, const char *text)
{
	expect(true, of(chip, property), text);
}

static uint8_t *memory(void)
{
	size_t size;

	return sim_slave_memory(chip, &size);
}

static void wait_s(unsigned seconds)
{
	host_run(&host, bus, host.now + seconds * HOST_S);
}

static const char page[] = "what is written into one page...";

static void test_a_memory_with_a_battery_is_read_and_written_by_pages(void)
{
	static const struct {
		const char *part, *last;
		unsigned at;
	} parts[] = {{"DS1992", "pages/page.3", 96},    {"DS1993", "pages/page.15", 480},
	             {"DS1995", "pages/page.63", 2016}, {"DS1996", "pages/page.255", 8160},
	             {"DS2404", "pages/page.15", 480},  {"DS1994", "pages/page.15", 480},
	             {"DS1963L", "pages/page.15", 480}, {"DS1963S", "pages/page.15", 480},
	             {"DS28E04", "pages/page.15", 480}, {"DS1977", "pages/page.510", 32640}};

	for (unsigned i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
		begin(parts[i].part);
		put(parts[i].last, page);
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE(page, memory() + parts[i].at, 32, parts[i].part);
		memory()[parts[i].at] = 'W';
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, parts[i].last), NULL);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, parts[i].part);
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE("What is", data[id], 7, parts[i].part);
		end();
	}
}

/* Of a long reading what is not begun is left out when its client is gone; a write goes on. */
static void test_a_long_reading_that_nobody_wants_any_more_ends(void)
{
	static char text[2001];
	static uint32_t gone;

	begin("DS1995");
	memset(text, 'x', sizeof(text) - 1);
	gone = 0;
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, "memory"), NULL);
	req[id].unwanted = &gone;
	wait_s(2);
	TEST_ASSERT_NULL(host_answer(&host, id));
	gone = 1;
	int64_t then = host.now;
	TEST_ASSERT_EQUAL_INT(-ECANCELED, answer_to(id)->err);
	TEST_ASSERT_LESS_THAN_INT64(then + HOST_S, host.now);
	/* One that has not begun */
	id = ask(BUS_READ, BUS_INPUT, true, of(chip, "memory"), NULL);
	req[id].unwanted = &gone;
	then = host.now;
	TEST_ASSERT_EQUAL_INT(-ECANCELED, answer_to(id)->err);
	TEST_ASSERT_LESS_THAN_INT64(then + HOST_S / 10, host.now);
	/* The chip is not left locked. */
	put("pages/page.63", page);
	gone = 0;
	id = ask(BUS_WRITE, BUS_INPUT, true, of(chip, "memory"), text);
	req[id].unwanted = &gone;
	wait_s(1);
	TEST_ASSERT_NULL(host_answer(&host, id));
	gone = 1;
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT32(2000, answer_to(id)->len);
	TEST_ASSERT_EQUAL_MEMORY(text, memory(), 2000);
	end();
}

static void test_an_eprom_is_read_and_refuses_to_be_written(void)
{
	static const struct {
		const char *part, *page, *status;
		unsigned at, status_at, status_bytes;
	} parts[] = {
		{"DS2505", "pages/page.63", "status/page.3", 2016, 2048 + 0x100, 8},
		{"DS1985U", "pages/page.1", "status/page.10", 32, 2048 + 0x138, 8},
		{"DS2506", "pages/page.255", "status/page.2", 8160, 8192 + 0x40, 32},
		{"DS1986U", "pages/page.9", "status/page.10", 288, 8192 + 0x1e0, 32},
	};

	for (unsigned i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
		begin(parts[i].part);
		memcpy(memory() + parts[i].at, page, 32);
		memory()[parts[i].status_at] = 0x5a;
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, parts[i].page), NULL);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, parts[i].part);
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE(page, data[id], 32, parts[i].part);
		id = ask(BUS_READ, BUS_INPUT, true, of(chip, parts[i].status), NULL);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, parts[i].part);
		TEST_ASSERT_EQUAL_UINT(parts[i].status_bytes, answer_to(id)->len);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x5a, data[id][0], parts[i].part);
		refuses(parts[i].page, "x", -EOPNOTSUPP);
		refuses(parts[i].status, "x", -EOPNOTSUPP);
		refuses("memory", "x", -EOPNOTSUPP);
		end();
	}
	begin("DS1982U");
	memcpy(memory(), "PROJ123456789", 13);
	expects("project", "PROJ");
	expects("mac_e", "123456");
	expects("mac_fw", "12345678");
	refuses("memory", "x", -EOPNOTSUPP);
}

static void test_a_page_that_is_written_counts_where_the_chip_counts_it(void)
{
	static const struct {
		const char *part, *first, *none;
	} rows[] = {{"DS1963L", "pages/count.12", "pages/count.11"},
	            {"DS1963S", "pages/count.8", "pages/count.7"}};

	for (unsigned i = 0; i < 2; i++) {
		begin(rows[i].part);
		put("pages/page.15", "a");
		put("pages/page.15", "b");
		expects("pages/count.15", "           2");
		expects("pages/count.14", "           0");
		expects(rows[i].first, "           0");
		TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(chip, rows[i].none), NULL));
		put("pages/page.15", "c");
		expects("pages/count.15", "           3");
		end();
	}
}

static void test_a_secret_is_refused(void)
{
	begin("DS1963S");
	refuses("password", "12345678", -EOPNOTSUPP);
	refuses("pages/password", "12345678", -EOPNOTSUPP);
	end();
	begin("DS1977");
	refuses("set_password/full", "12345678", -EOPNOTSUPP);
	refuses("set_password/read", "12345678", -EOPNOTSUPP);
	refuses("set_password/enabled", "1", -EOPNOTSUPP);
	refuses("use_password/full", "12345678", -EOPNOTSUPP);
	refuses("use_password/read", "12345678", -EOPNOTSUPP);
}

static void test_the_subkeys_of_a_ds1991_show_their_identifiers_alone(void)
{
	static const char *const parts[] = {"DS1991", "DS1425"};

	for (unsigned i = 0; i < 2; i++) {
		begin(parts[i]);
		memcpy(memory() + 64, "my keys!", 8);
		expects("subkey1/id.abc", "my keys!");
		expects("subkey1/id.B", "my keys!");
		expects("subkey1/id.D", "my keys!");
		expects("subkey1/id.7", "my keys!");
		refuses("subkey1/id.abc", "12345678", -EOPNOTSUPP);
		refuses("subkey1/password.abc", "12345678", -EOPNOTSUPP);
		refuses("subkey1/reset.abc", "1", -EOPNOTSUPP);
		refuses("subkey1/secure_data.abc", "12345678", -EOPNOTSUPP);
		TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP,
		                      result(BUS_READ, of(chip, "subkey1/secure_data.abc"), NULL));
		TEST_ASSERT_EQUAL_MEMORY("my keys!", memory() + 64, 8);
		end();
	}
}

static void test_a_ds2438_with_the_family_code_a6_is_one(void)
{
	begin("DS2438-A6");
	wire_set(chip, "temperature", 21.5);
	wire_set(chip, "vdd", 4.75);
	expects("temperature", "        21.5");
	expects("VDD", "        4.75");
	expects("type", "DS2438");
}

static void test_a_ds1977_is_read_as_long_as_no_password_is_switched_on(void)
{
	begin("DS1977");
	expects("version", "           1");
	expects("set_password/enabled", "0");
	memcpy(memory() + 64, page, 32);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(chip, "pages/page.1"), NULL));
	memory()[0x7fc0] = 1;
	memory()[0x7fc8] = 2;
	memory()[0x7fd0] = 0xaa;
	TEST_ASSERT_LESS_THAN_INT(0, result(BUS_READ, of(chip, "pages/page.1"), NULL));
	TEST_ASSERT_LESS_THAN_INT(0, result(BUS_WRITE, of(chip, "pages/page.1"), "x"));
	TEST_ASSERT_EQUAL_MEMORY(page, memory() + 64, 32);
}

/* Slots that a read of all of the memory takes, with one turned over. */
static uint32_t slots_of_a_read(uint32_t turned)
{
	static struct trouble trouble;

	begin("DS1995");
	for (unsigned i = 0; i < 2048; i++)
		memory()[i] = (uint8_t)(i * 7 + i / 256);
	wire_net.trouble = &trouble;
	trouble_none(&trouble);
	trouble.at = turned;
	trouble.mask = 1;
	trouble.kind = turned ? TROUBLE_TURN : TROUBLE_NONE;
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, "memory"), NULL);

	wait_s(60);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT(2048, answer_to(id)->len);
	TEST_ASSERT_EQUAL_MEMORY(memory(), data[id], 2048);
	wire_net.trouble = NULL;
	uint32_t slots = trouble.slots;

	end();
	return slots;
}

static void test_of_a_large_memory_what_was_read_wrong_is_read_again_alone(void)
{
	uint32_t plain = slots_of_a_read(0);
	uint32_t again = slots_of_a_read(plain - plain / 8);

	TEST_ASSERT_GREATER_THAN_UINT32(plain, again);
	TEST_ASSERT_LESS_THAN_UINT32(plain + plain / 2 + plain / 8, again);
}

static void test_a_clock_runs_when_it_is_told_to(void)
{
	static const char *const parts[] = {"DS2415", "DS2417", "DS2404"};

	for (unsigned i = 0; i < 3; i++) {
		begin(parts[i]);
		expects("running", "0");
		put("udate", "1000000");
		wait_s(10);
		expects("udate", "     1000000");
		put("running", "1");
		expects("running", "1");
		wait_s(100);
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, "udate"), NULL);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, parts[i]);
		TEST_ASSERT_INT_WITHIN_MESSAGE(1, 1000100, (int)answer_to(id)->number, parts[i]);
		put("udate", "2000000000");
		wait_s(5);
		put("running", "0");
		id = ask(BUS_READ, BUS_INPUT, true, of(chip, "udate"), NULL);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, parts[i]);
		TEST_ASSERT_INT_WITHIN_MESSAGE(1, 2000000005, (int)answer_to(id)->number, parts[i]);
		put("date", "Sat Jan  1 00:00:07 2000");
		expects("udate", "   946684807");
		end();
	}
}

static void test_the_other_bits_of_a_clocks_control_byte_stay(void)
{
	begin("DS2415");
	put("user", "9");
	put("running", "1");
	expects("ControlRegister", "         156");
	put("user", "3");
	expects("running", "1");
	put("ControlRegister", "0");
	expects("user", "           0");
	end();
	begin("DS2417");
	put("itime", "30");
	expects("interval", "           2");
	expects("itime", "          32");
	expects("enable", "1");
	put("itime", "0");
	expects("enable", "0");
	expects("itime", "          32");
	put("interval", "7");
	expects("itime", "      131072");
	refuses("interval", "8", -EINVAL);
	refuses("itime", "-1", -EINVAL);
	expects("running", "0");
}

static void test_a_wiper_is_put_where_it_is_told(void)
{
	begin("DS2890");
	expects("wiper", "           0");
	put("wiper", "200");
	expects("wiper", "         200");
	expects("chargepump", "0");
	put("chargepump", "1");
	expects("chargepump", "1");
	expects("wiper", "         200");
	refuses("wiper", "256", -EINVAL);
}

static void test_the_registers_of_a_ds2404_are_written_one_by_one(void)
{
	static const char *const flags[] = {"auto", "delay", "running"};

	begin("DS2404");
	for (unsigned i = 0; i < 3; i++) {
		expects(flags[i], "0");
		put(flags[i], "1");
		expects(flags[i], "1");
	}
	put("delay", "0");
	expects("running", "1");
	put("trigger/udate", "77");
	put("trigger/interval_udate", "88");
	put("trigger/cycle", "99");
	put("cycle", "5");
	expects("trigger/udate", "          77");
	expects("trigger/interval_udate", "          88");
	expects("trigger/cycle", "          99");
	expects("cycle", "           5");
	put("interval/udate", "1234");
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, "interval/udate"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_INT_WITHIN(1, 1234, (int)answer_to(id)->number);
	expects("readonly/clock", "0");
	put("readonly/clock", "1");
	expects("readonly/clock", "1");
	refuses("readonly/clock", "0", -EIO);
	refuses("udate", "4", -EIO);
}

/* Its bit in the chip stops it. */
static void test_the_interval_timer_of_a_ds2404_counts_between_start_and_stop(void)
{
	begin("DS2404");
	put("running", "1");
	put("auto", "0");
	put("interval/udate", "100");
	expects("start", "1");
	wait_s(10);
	put("start", "0");
	expects("start", "0");
	TEST_ASSERT_EQUAL_HEX8(0x40, memory()[0x201] & 0x40);
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, "interval/udate"), NULL);
	double stopped = answer_to(id)->number;

	TEST_ASSERT_DOUBLE_WITHIN(2, 110, stopped);
	wait_s(20);
	id = ask(BUS_READ, BUS_INPUT, true, of(chip, "interval/udate"), NULL);
	TEST_ASSERT_EQUAL_DOUBLE(stopped, answer_to(id)->number);
	put("start", "1");
	wait_s(20);
	id = ask(BUS_READ, BUS_INPUT, true, of(chip, "interval/udate"), NULL);
	TEST_ASSERT_DOUBLE_WITHIN(2, stopped + 20, answer_to(id)->number);
}

/* The status register loses its flags when it is read. */
static void test_an_alarm_of_a_ds2404_is_reported_once_whoever_reads_the_register(void)
{
	begin("DS2404");
	put("set_alarm", "110"); /* 0 enables: that of the clock */
	expects("set_alarm", "         110");
	expects("alarm", "           0");
	put("trigger/udate", "1000");
	put("udate", "995");
	put("running", "1");
	wait_s(10);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_DIR, "/uncached/alarm", NULL));
	expects("set_alarm", "         110");
	expects("alarm", "           1");
	expects("alarm", "           0");
}

static void test_the_switches_of_a_ds28e04(void)
{
	begin("DS28E04");
	expects("sensed.ALL", "1,1");
	expects("PIO.ALL", "0,0");
	put("PIO.0", "1");
	expects("PIO.ALL", "1,0");
	expects("sensed.ALL", "0,1");
	expects("PIO.BYTE", "           1");
	put("PIO.BYTE", "2");
	expects("sensed.ALL", "1,0");
	put("PIO.ALL", "0,0");
	put("latch.BYTE", "0");
	expects("latch.ALL", "0,0");
	wire_set(chip, "pin.1", 0);
	host_run(&host, bus, host.now + HOST_MS);
	expects("latch.ALL", "0,1");
	expects("power", "1");
	expects("polarity", "1");
	expects("por", "1");
	put("por", "0");
	expects("por", "0");
	refuses("por", "1", -EOPNOTSUPP);
	put("set_alarm", "123");
	expects("set_alarm", "         123");
	expects("por", "0");
	refuses("set_alarm", "400", -EINVAL);
}

static void test_what_follows_the_memory_of_a_ds28e04_is_not_written(void)
{
	begin("DS28E04");
	write_offset = 511;
	put("memory", "x");
	TEST_ASSERT_EQUAL_HEX8('x', memory()[511]);
	write_offset = 512;
	refuses("memory", "x", -EOPNOTSUPP);
	write_offset = 0;
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(chip, "memory"), NULL));
}

static void test_the_memory_of_a_ds2404_is_one_with_its_pages(void)
{
	begin("DS2404");
	put("pages/page.1", page);
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, "memory"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT(512, answer_to(id)->len);
	TEST_ASSERT_EQUAL_MEMORY(page, data[id] + 32, 32);
}

/* Six seconds of the wire: who comes later waits for a part of them. */
static void others_have_their_turn_during(enum bus_op op, const char *property, const char *text)
{
	int64_t longest = 0, begun;
	unsigned n = 0;

	native_begin();
	wire_init(&host, 1, 1);
	chip = wire_add(0, "DS1995", 1);
	struct sim_slave *input = wire_add(0, "DS2413", 2);
	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(input, "sensed.BYTE"), NULL));
	begun = host.now;
	uint32_t id = ask(op, BUS_INPUT, true, of(chip, property), text);
	while (!host_answer(&host, id) && n < 200) {
		int64_t asked = host.now;

		n++;
		TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(input, "sensed.BYTE"), NULL));
		if (host.now - asked > longest)
			longest = host.now - asked;
	}
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_GREATER_THAN_INT64(2 * HOST_S, host.now - begun);
	TEST_ASSERT_LESS_THAN_INT64(3 * HOST_S / 4, longest);
	native_end();
}

static void test_who_reads_or_writes_much_lets_others_have_their_turn(void)
{
	char text[2001];

	memset(text, 'x', sizeof(text) - 1);
	text[sizeof(text) - 1] = '\0';
	others_have_their_turn_during(BUS_READ, "memory", NULL);
	others_have_their_turn_during(BUS_READ, "pages/page.ALL", NULL);
	others_have_their_turn_during(BUS_WRITE, "memory", text);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_memory_with_a_battery_is_read_and_written_by_pages);
	RUN_TEST(test_a_long_reading_that_nobody_wants_any_more_ends);
	RUN_TEST(test_an_eprom_is_read_and_refuses_to_be_written);
	RUN_TEST(test_a_page_that_is_written_counts_where_the_chip_counts_it);
	RUN_TEST(test_a_secret_is_refused);
	RUN_TEST(test_the_subkeys_of_a_ds1991_show_their_identifiers_alone);
	RUN_TEST(test_a_ds2438_with_the_family_code_a6_is_one);
	RUN_TEST(test_a_ds1977_is_read_as_long_as_no_password_is_switched_on);
	RUN_TEST(test_of_a_large_memory_what_was_read_wrong_is_read_again_alone);
	RUN_TEST(test_a_clock_runs_when_it_is_told_to);
	RUN_TEST(test_the_other_bits_of_a_clocks_control_byte_stay);
	RUN_TEST(test_a_wiper_is_put_where_it_is_told);
	RUN_TEST(test_the_registers_of_a_ds2404_are_written_one_by_one);
	RUN_TEST(test_the_interval_timer_of_a_ds2404_counts_between_start_and_stop);
	RUN_TEST(test_an_alarm_of_a_ds2404_is_reported_once_whoever_reads_the_register);
	RUN_TEST(test_the_switches_of_a_ds28e04);
	RUN_TEST(test_what_follows_the_memory_of_a_ds28e04_is_not_written);
	RUN_TEST(test_the_memory_of_a_ds2404_is_one_with_its_pages);
	RUN_TEST(test_who_reads_or_writes_much_lets_others_have_their_turn);
	return UNITY_END();
}
