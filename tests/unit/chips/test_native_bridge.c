/* SPDX-License-Identifier: MIT */
/*
 * Sensors behind a DS28E17, measured as the shipped table says: the values are those that the
 * simulated sensors were given, or there is an error, whatever is lost on the wire.
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

static const char *part = "DS28E17", *rom_id = "19.01005DDF0300";
static struct sim_slave *bridge;
static struct trouble trouble;

void setUp(void)
{
}

void tearDown(void)
{
	native_end();
	wire_net.trouble = NULL;
}

static void option(const char *name, double address)
{
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(bridge, name, address));
}

/* The shipped kinds, and these lines behind them. */
static int take(const char *lines, char *why, size_t why_size)
{
	char file[] = "/tmp/owsd-sensors-XXXXXX", text[8000];
	FILE *shipped = fopen("docs/examples/sensors.table", "re"), *out;
	size_t n;
	int err, fd = mkstemp(file);

	TEST_ASSERT_NOT_NULL(shipped);
	n = fread(text, 1, sizeof(text), shipped);
	TEST_ASSERT_LESS_THAN_UINT(sizeof(text), n);
	fclose(shipped);
	out = fdopen(fd, "w");
	fwrite(text, 1, n, out);
	fputs(lines, out);
	fclose(out);
	err = bus_option(bus, "Sensors", file, why, why_size);
	unlink(file);
	return err;
}

static void begin(void)
{
	char why[160] = "", lines[400];

	native_begin();
	wire_init(&host, 1, 1);
	wire_net.trouble = &trouble;
	trouble_none(&trouble);
	bridge = wire_add(0, part, 1);
	option("sht4x", 0x44);
	option("bme280", 0x76);
	option("vcnl4040", 0x60);
	option("mcp23017", 0x20);
	sim_slave_power_on(bridge, wire_time());
	wire_set(bridge, "temperature", 21.5);
	wire_set(bridge, "humidity", 44);
	wire_set(bridge, "pressure", 987.5);
	wire_set(bridge, "light", 123.4);
	wire_set(bridge, "proximity", 321);
	wire_set(bridge, "pins", 0x1234);
	bus = wire_open();
	snprintf(lines, sizeof(lines),
	         "sensor narrow\n\twrite 0x12 read 1\n\tvalue v = u8(0) range 0 to 10\n"
	         "at %s sht4x 0x44\nat %s bme280 0x76 as air\nat %s vcnl4040 0x60\n"
	         "at %s mcp23017 0x20 as io\nat %s narrow 0x20 as narrow\n",
	         rom_id, rom_id, rom_id, rom_id, rom_id);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, take(lines, why, sizeof(why)), why);
	host_run(&host, bus, host.now + 2 * HOST_S);
	forget();
}

/* By its own id, which a DS28E18 has only while it is awake. */
static const char *path_of(const char *property)
{
	static char paths[4][60];
	static unsigned turn;
	char *path = paths[turn++ % 4];

	snprintf(path, sizeof(paths[0]), "/%s%s%s", rom_id, *property ? "/" : "", property);
	return path;
}

static double number(const char *property)
{
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, path_of(property), NULL);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, property);
	return answer_to(id)->number;
}

static void test_each_shipped_sensor_is_measured(void)
{
	begin();
	TEST_ASSERT_DOUBLE_WITHIN(0.01, 21.5, number("temperature"));
	TEST_ASSERT_DOUBLE_WITHIN(0.01, 44, number("humidity"));
	TEST_ASSERT_DOUBLE_WITHIN(0.01, 21.5, number("air/temperature"));
	TEST_ASSERT_DOUBLE_WITHIN(0.05, 987.5, number("air/pressure"));
	TEST_ASSERT_DOUBLE_WITHIN(0.05, 44, number("air/humidity"));
	TEST_ASSERT_DOUBLE_WITHIN(0.001, 123.4, number("light"));
	TEST_ASSERT_DOUBLE_WITHIN(0.001, 321, number("proximity"));
	TEST_ASSERT_EQUAL_HEX16(0x1234, (uint16_t)number("io/pins"));
	TEST_ASSERT_EQUAL_HEX16(0xFFFF, (uint16_t)number("io/direction"));
	wire_set(bridge, "temperature", -30);
	TEST_ASSERT_DOUBLE_WITHIN(0.01, -30, number("temperature"));
	TEST_ASSERT_DOUBLE_WITHIN(0.01, -30, number("air/temperature"));
}

static void test_outputs_are_written_and_read_back(void)
{
	begin();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, path_of("io/latch"), "258"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, path_of("io/direction"), "0"));
	TEST_ASSERT_EQUAL_HEX16(0x0102, (uint16_t)number("io/pins"));
	TEST_ASSERT_EQUAL_HEX16(0x0102, (uint16_t)number("io/latch"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, path_of("io/latch"), "65536"));
	TEST_ASSERT_EQUAL_INT(-EACCES, result(BUS_WRITE, path_of("io/pins"), "0"));
}

static void test_the_values_are_listed_and_two_of_one_sensor_are_one_measurement(void)
{
	uint32_t first, second;
	uint64_t before;

	begin();
	first = ask(BUS_DIR, BUS_INPUT, false, path_of(""), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(first)->err);
	TEST_ASSERT_NOT_NULL(strstr((char *)data[first], "/humidity\n"));
	TEST_ASSERT_NOT_NULL(strstr((char *)data[first], "/air\n"));
	TEST_ASSERT_NULL(strstr((char *)data[first], "/air/humidity\n"));
	expect(false, path_of("type"), part);
	first = ask(BUS_DIR, BUS_INPUT, false, path_of("air"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(first)->err);
	TEST_ASSERT_NOT_NULL(strstr((char *)data[first], "/air/pressure\n"));
	before = bridge->conversions;
	first = ask(BUS_READ, BUS_INPUT, true, path_of("temperature"), NULL);
	second = ask(BUS_READ, BUS_INPUT, true, path_of("humidity"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(first)->err);
	TEST_ASSERT_EQUAL_INT(0, answer_to(second)->err);
	TEST_ASSERT_EQUAL_UINT64(before + 1, bridge->conversions);
}

static void test_a_sensor_that_is_not_there_or_another_is_an_error(void)
{
	begin();
	option("sht4x", 0x45);
	TEST_ASSERT_EQUAL_INT(-EIO, result(BUS_READ, path_of("temperature"), NULL));
	option("bme280", 0x77);
	option("vcnl4040", 0x76);
	TEST_ASSERT_EQUAL_INT(-EIO, result(BUS_READ, path_of("air/temperature"), NULL));
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, path_of("nonsense"), NULL));
}

/* Without power it has forgotten its id. */
static void test_what_the_sensor_cannot_mean_is_refused_with_its_number(void)
{
	begin();
	const struct bus_answer *answer = answer_to(
		ask(BUS_READ, BUS_INPUT, true, path_of("narrow/v"), NULL));
	TEST_ASSERT_EQUAL_INT(-EDOM, answer->err);
	TEST_ASSERT_EQUAL_DOUBLE(0x34, answer->number);
}

static void test_a_bridge_that_lost_its_power_is_woken(void)
{
	begin();
	TEST_ASSERT_DOUBLE_WITHIN(0.01, 21.5, number("temperature"));
	sim_slave_brownout(bridge, wire_time());
	TEST_ASSERT_NOT_EQUAL_INT(0, result(BUS_READ, path_of("temperature"), NULL));
	host_run(&host, bus, host.now + 20 * HOST_S);
	TEST_ASSERT_DOUBLE_WITHIN(0.01, 21.5, number("temperature"));
}

/* It gets an id again and again, which is no reason to call all searches of the wire disturbed. */
static void test_a_bridge_that_does_not_stay_awake_keeps_no_device_that_is_lost(void)
{
	begin();
	struct sim_slave *room = wire_add(0, "DS18B20", 2);

	host_run(&host, bus, host.now + 20 * HOST_S);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(room, "temperature"), NULL));
	sim_wire_plug(&wire_net.wire[0], room, false, wire_time());
	bool lost = false;
	for (unsigned i = 0; i < 600; i++) {
		host.events = 0;
		sim_slave_brownout(bridge, wire_time());
		host_run(&host, bus, host.now + 100 * HOST_MS);
		for (unsigned n = 0; n < host.events; n++)
			lost |= host.event[n].news == BUS_LOST &&
			        host.event[n].rom[0] == room->rom[0];
	}
	TEST_ASSERT_TRUE(lost);
}

/* --- Trouble --------------------------------------------------------------------------------- */

static const char *property;
static double low, high;              /* what is true */
static unsigned errors, wrong, again; /* again: it was repeated */
static uint32_t most_slots;

/* The sensor measured other values before. */
static void once(struct trouble what)
{
	uint32_t id;

	begin();
	number(property);
	wire_set(bridge, "temperature", 60);
	wire_set(bridge, "humidity", 80);
	wire_set(bridge, "light", 3000);
	wire_set(bridge, "pins", 0x4321);
	host_run(&host, bus, host.now + 3 * HOST_S);
	forget();
	trouble_none(&trouble);
	what.restart_ns += what.restart_ns ? wire_time() : 0;
	trouble.kind = what.kind;
	trouble.at = what.at;
	trouble.mask = what.mask;
	trouble.restart_ns = what.restart_ns;
	id = ask(BUS_READ, BUS_INPUT, true, path_of(property), NULL);
	errors += answer_to(id)->err != 0;
	again += answer_to(id)->err == 0 && trouble.slots > most_slots;
	if (!answer_to(id)->err &&
	    !(answer_to(id)->number >= low && answer_to(id)->number <= high)) {
		printf("%s: %g with trouble %d at %u\n", property, answer_to(id)->number,
		       (int)what.kind, (unsigned)what.at);
		wrong++;
	}
	trouble.kind = TROUBLE_NONE;
}

static void try_all(const char *which, double least, double most, unsigned stride)
{
	uint32_t slots;

	property = which;
	low = least;
	high = most;
	errors = wrong = again = 0;
	most_slots = UINT32_MAX;
	once((struct trouble){.kind = TROUBLE_NONE});
	TEST_ASSERT_EQUAL_UINT(0, errors);
	slots = most_slots = trouble.slots;
	tearDown();
	for (uint32_t at = 0; at < slots; at += stride) {
		once((struct trouble){.kind = TROUBLE_TURN, .at = at, .mask = 1});
		tearDown();
		once((struct trouble){.kind = TROUBLE_DEAF, .at = at});
		tearDown();
	}
	for (int64_t ms = 1; ms < 200; ms += 2) {
		once((struct trouble){.kind = TROUBLE_RESTART, .restart_ns = ms * HOST_MS});
		tearDown();
	}
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	TEST_ASSERT_GREATER_THAN_UINT(10, again);
	begin();
}

static void test_a_sensor_with_checksums_gives_no_false_value(void)
{
	try_all("temperature", 59.9, 60.1, 1);
}

static void test_a_sensor_with_registers_gives_no_false_value(void)
{
	try_all("light", 2999, 3001, 3);
	tearDown();
	try_all("io/pins", 0x4321, 0x4321, 3);
}

static void test_a_sensor_with_a_calibration_gives_no_false_value(void)
{
	try_all("air/temperature", 59.9, 60.1, 29);
}

/* As long as a bridge is busy its read slots are ones, as those of one that has gone. */
static void test_a_bridge_that_says_nothing_is_not_waited_for_without_end(void)
{
	uint32_t slots, most = 0;
	int64_t begun, took, longest = 0;

	property = "light";
	low = 2999;
	high = 3001;
	wrong = 0;
	most_slots = UINT32_MAX;
	once((struct trouble){.kind = TROUBLE_NONE});
	slots = trouble.slots;
	tearDown();
	for (uint32_t at = 0; at < slots; at += 5) {
		begun = host.now;
		once((struct trouble){.kind = TROUBLE_DEAF, .at = at});
		took = host.now - begun;
		most = trouble.slots > most ? trouble.slots : most;
		longest = took > longest ? took : longest;
		tearDown();
	}
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	/* the visit twice, and between them twice the slots of the bytes that were asked for */
	TEST_ASSERT_LESS_THAN_UINT32(2 * slots + 300, most);
	TEST_ASSERT_LESS_THAN_INT64(20 * HOST_S, longest);
	begin();
}

static void test_a_write_that_succeeded_is_there_whatever_was_lost(void)
{
	uint32_t slots;

	begin();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, path_of("io/latch"), "258"));
	slots = trouble.slots;
	tearDown();
	for (uint32_t at = 0; at < slots; at += 3) {
		for (unsigned kind = TROUBLE_TURN; kind <= TROUBLE_DEAF; kind++) {
			int err;

			begin();
			trouble_none(&trouble);
			trouble.kind = (enum trouble_kind)kind;
			trouble.at = at;
			trouble.mask = 1;
			err = result(BUS_WRITE, path_of("io/latch"), "258");
			trouble.kind = TROUBLE_NONE;
			if (!err)
				TEST_ASSERT_EQUAL_UINT(258, (unsigned)number("io/latch"));
			tearDown();
		}
	}
	begin();
}

/* --- The language ---------------------------------------------------------------------------- */

static void test_errors_of_a_table_have_their_line_and_reason(void)
{
	static const struct {
		const char *lines, *line, *reason;
	} tables[] = {
		{"at 19.01005DDF0300 nothing 0x44\n", ":69:", "no sensor nothing"},
		{"at 28.01005DDF0300 sht4x 0x44\n", ":69:", "expected the id of a bridge"},
		{"at 19.01005DDF0300 sht4x 0x88\n", ":69:", "from 8 to 119"},
		{"at 19.01005DDF0300 sht4x 0x44\nat 19.01005DDF0300 sht4x 0x45\n",
	         ":70:", "of this name already"},
		{"sensor x\n\twrite 1 read 1\n\tvalue present unsigned = 1\nat 19.01005DDF0300 x 0x44\n",
	         ":72:", "of this name already"},
		{"at 19.01005DDF0300 sht4x 0x44 as family\n", ":69:", "of this name already"},
		{"sensor x\n\twrite 1 read 1\n\tlet a = 1\n\tlet a = 2\n\tvalue v unsigned = a\n",
	         ":72:", "a name a already"},
		{"sensor x\n\twrite 1\n\tvalue v unsigned = 1\n", ":71:", "reads nothing"},
		{"sensor x\n\twrite 300\n", ":70:", "not from 0 to 255"},
		{"sensor x\n\twrite 1 read 2\n\tvalue v = u16(1)\n", ":71:", "not read before"},
		{"sensor x\n\tread 2\n\tvalue v unsigned = u16(0)\n", ":71:", "has no checksum"},
		{"sensor x\n\twrite 1 read 40\n", ":70:", "from 1 to 32"},
		{"sensor x\n\twait 9\n", ":70:", "a time as"},
		{"sensor x\n\twrite 1 read 1\n\tvalue v = (u8(0)\n", ":71:", "expected )"},
		{"sensor x\n\twrite 1 read 1\n\tvalue v = nothing\n", ":71:", "no such name"},
		{"sensor x\n\twrite 1 read 2\n\tvalue v unsigned = u16(0) / 0\n",
	         ":71:", "a division by 0"},
		{"sensor x\n\twrite 1 read 1\n\tlet a = u8(0) / (3 - 1 - floor(2.5))\n",
	         ":71:", "a division by 0"},
		{"sensor x\n\twrite 1 read 1\n\tlet a = pow(0, -1)\n", ":71:", "never a number"},
		{"sensor x\n\twrite 1 read 1\n\tvalue v yesno = u8(0) range 0 to 2\n",
	         ":71:", "beyond that of the type, 0 to 1"},
		{"sensor x\n\twrite 1 read 1\n\tvalue v unsigned = u8(0) range -1 to 5\n",
	         ":71:", "beyond that of the type, 0 to 4294967295"},
		{"sensor x\n\twrite 1 read 1\n\tvalue v integer = s8(0) range -3e9 to 5\n",
	         ":71:", "beyond that of the type, -2147483648 to 2147483647"},
		{"sensor x\n\tset v write 1\n", ":70:", "expected a value v"},
		{"sensor sht4x\n", ":69:", "already, in line 5"},
		{"sensor x\n", ":69:", "has no value"},
		{"hello\n", ":69:", "expected sensor"},
		{"sensor x\n\twrite 1 read 1\n\tvalue v = u8(0) range 5 to 1\n", ":71:", "empty"},
		{"sensor x\n\twrite 1 read 1\n\tvalue v = u8(0) range -inf to inf\n",
	         ":71:", "expected a number"},
		{"sensor x\n\twrite 1 read 1\n\tvalue v = u8(0)\n", ":71:", "v has no range"},
		{"sensor x\n\twrite 1 read 1\n\tvalue v temperature = u8(0)\n",
	         ":71:", "v has no range"},
		{"sensor x\n\twrite 1 read 1\n\tvalue v unsigned = 2 * u8(0) + z\n",
	         ":71:", "no such name at \"z\", in the formula \"2 * u8(0) + z\""},
		{"sensor x\n\twrite 1 read 1\n\tlet a = 3 * (u8(0)\n",
	         ":71:", "in the formula \"3 * (u8(0)\""},
		{"sensor x\n\twrite (u8(0))\n", ":70:", "in the formula \"(u8(0))\""},
		{"sensor x\n\twrite 1 read 1\n\twait 6000ms\n\twait 4000.1ms\n",
	         ":72:", "more than 10000 ms in all"},
		/* Lines that end as those of other systems are lines, too. */
		{"sensor x\r\twrite 1 read 1\r\tvalue v = 1 +\r", ":71:", "expected a number"},
		{"sensor x\r\n\twrite 1 read 1\r\n\tvalue v = 1 +\r\n",
	         ":71:", "expected a number"},
		{"sensor x # a comment\rhello\r", ":70:", "expected sensor"},
		{"sensor x\n\r\rhello\n", ":72:", "expected sensor"},
	};

	begin();
	for (unsigned i = 0; i < sizeof(tables) / sizeof(tables[0]); i++) {
		char why[160] = "";

		TEST_ASSERT_EQUAL_INT(-EINVAL, take(tables[i].lines, why, sizeof(why)));
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, tables[i].line), why);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, tables[i].reason), why);
	}
}

/* Of one sensor; the waits of another are its own. */
static void test_a_sensor_may_wait_for_10_s_in_all(void)
{
	static const char lines[] = "sensor x\n\twrite 1 read 1\n\twait 6000ms\n\twait 4000ms\n"
				    "\tvalue v unsigned = u8(0)\n"
				    "sensor y\n\twait 10000ms\n\twrite 1 read 1\n"
				    "\tvalue v = u8(0) / 2 range 0 to 127.5\n";
	char why[160] = "";

	begin();
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, take(lines, why, sizeof(why)), why);
}

/* More lines than a measurement can count would never end. */
static void test_a_sensor_has_255_lines_to_do_at_most(void)
{
	static const char line[] = "\tcheck 1 = 1\n";
	char why[160] = "", lines[300 * sizeof(line)];

	begin();
	for (unsigned checks = 254; checks <= 255; checks++) {
		int n = snprintf(lines, sizeof(lines), "sensor x\n\twrite 1 read 1\n");

		for (unsigned i = 0; i < checks; i++)
			n += snprintf(lines + n, sizeof(lines) - (size_t)n, "%s", line);
		snprintf(lines + n, sizeof(lines) - (size_t)n, "\tvalue v unsigned = u8(0)\n");
		TEST_ASSERT_EQUAL_INT_MESSAGE(checks == 254 ? 0 : -EINVAL,
		                              take(lines, why, sizeof(why)), why);
	}
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, "more than 255 lines"), why);
}

static void test_a_file_that_cannot_be_read_is_refused(void)
{
	char why[160] = "";

	begin();
	TEST_ASSERT_EQUAL_INT(-EINVAL,
	                      bus_option(bus, "Sensors", "/nowhere/at/all", why, sizeof(why)));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, "No such file"), why);
}

static void test_random_tables_are_refused_or_taken_but_never_crash(void)
{
	static const char *const words[] = {
		"sensor", "a",     "write", "read",  "wait", "check",
		"crc8",   "let",   "value", "set",   "at",   "19.01005DDF0300",
		"0x44",   "9ms",   "=",     "u8(0)", "(",    ")",
		"+",      "-",     "*",     "$",     "\n",   "1",
		"as",     "range", "to",    "bits(", ",",    "s32le(2)",
		"\n\t",   "#",     "1e308", "0x",    "min("};
	uint32_t seed = 1;
	char text[600], why[160];

	begin();
	for (unsigned round = 0; round < 3000; round++) {
		size_t n = 0;

		text[0] = '\0';
		for (unsigned i = 0; i < 40; i++) {
			seed = seed * 1664525 + 1013904223;
			n += (size_t)snprintf(
				text + n, sizeof(text) - n, "%s ",
				words[(seed >> 8) % (sizeof(words) / sizeof(words[0]))]);
		}
		TEST_ASSERT_NOT_EQUAL_INT(-ENOMEM, take(text, why, sizeof(why)));
	}
}

static void over_both(void)
{
	RUN_TEST(test_each_shipped_sensor_is_measured);
	RUN_TEST(test_outputs_are_written_and_read_back);
	RUN_TEST(test_the_values_are_listed_and_two_of_one_sensor_are_one_measurement);
	RUN_TEST(test_a_sensor_that_is_not_there_or_another_is_an_error);
	RUN_TEST(test_what_the_sensor_cannot_mean_is_refused_with_its_number);
	RUN_TEST(test_a_sensor_with_checksums_gives_no_false_value);
	RUN_TEST(test_a_sensor_with_registers_gives_no_false_value);
	RUN_TEST(test_a_sensor_with_a_calibration_gives_no_false_value);
	RUN_TEST(test_a_bridge_that_says_nothing_is_not_waited_for_without_end);
	RUN_TEST(test_a_write_that_succeeded_is_there_whatever_was_lost);
}

int main(void)
{
	UNITY_BEGIN();
	over_both();
	RUN_TEST(test_errors_of_a_table_have_their_line_and_reason);
	RUN_TEST(test_a_sensor_has_255_lines_to_do_at_most);
	RUN_TEST(test_a_sensor_may_wait_for_10_s_in_all);
	RUN_TEST(test_a_file_that_cannot_be_read_is_refused);
	RUN_TEST(test_random_tables_are_refused_or_taken_but_never_crash);
	part = "DS28E18";
	rom_id = "56.01005DDF0300";
	over_both();
	RUN_TEST(test_a_bridge_that_lost_its_power_is_woken);
	RUN_TEST(test_a_bridge_that_does_not_stay_awake_keeps_no_device_that_is_lost);
	return UNITY_END();
}
