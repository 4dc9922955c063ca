/* SPDX-License-Identifier: MIT */
/* Tests of the native bus: finding, reading, listing, errors. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/bus/backends.h"
#include "hal/chips/find.h"
#include "tests/unit/aid/native_scene.h"

void setUp(void)
{
	native_begin();
}

void tearDown(void)
{
	native_end();
}

static void test_a_thermometer_is_found_and_read(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 21.0625);
	start();
	expect(true, of(slave, "temperature"), "     21.0625");
	expect(true, of(slave, "temperature9"), "          21");
	expect(true, of(slave, "temperature12"), "     21.0625");
	expect(true, of(slave, "type"), "DS18B20");
	expect(true, of(slave, "family"), "28");
	expect(true, of(slave, "power"), "1");
	expect(true, of(slave, "tempres"), "          12");
	expect(true, of(slave, "present"), "1");
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_FOUND));
}

/* Which of its properties a chip has may depend on what is known of it: nothing is. */
static void test_no_property_of_a_device_that_was_never_seen_is_there(void)
{
	static const enum bus_op ops[] = {BUS_READ, BUS_WRITE, BUS_DIR, BUS_PROBE};
	const struct family *family;
	unsigned asked = 0;

	wire_init(&host, 1, 1);
	start();
	for (unsigned n = 0; (family = family_nth(n)); n++) {
		const struct property *property = NULL;

		while ((property = family_next(family, NULL, property)))
			for (unsigned k = 0; k < sizeof(ops) / sizeof(ops[0]); k++, asked++) {
				char what[80];

				snprintf(what, sizeof(what), "/%02X.AABBCCDDEEFF/%s", family->code,
				         property->name);
				TEST_ASSERT_LESS_THAN_INT_MESSAGE(0, result(ops[k], what, "1"),
				                                  what);
				forget();
			}
	}
	TEST_ASSERT_GREATER_THAN_UINT(1000, asked);
}

static void test_the_listing_has_devices_and_directories(void)
{
	wire_init(&host, 2, 2);
	wire_add(0, "DS18B20", 1);
	wire_add(1, "DS2401", 2);
	start();
	uint32_t id = ask(BUS_DIR, BUS_INPUT, true, "/", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_NOT_NULL(strstr((char *)data[id], "/28.01005DDF0300\n"));
	TEST_ASSERT_NOT_NULL(strstr((char *)data[id], "/01.02005DDF0300\n"));
	TEST_ASSERT_NOT_NULL(strstr((char *)data[id], "/bus.1\n"));
	TEST_ASSERT_NOT_NULL(strstr((char *)data[id], "/alarm\n"));
	id = ask(BUS_DIR, BUS_INPUT, false, "/bus.1", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING("/bus.1/01.02005DDF0300\n/bus.1/interface\n/bus.1/simultaneous\n"
	                         "/bus.1/alarm\n",
	                         (char *)data[id]);
	id = ask(BUS_DIR, BUS_INPUT, false, "/01.02005DDF0300", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_NOT_NULL(strstr((char *)data[id], "/01.02005DDF0300/address\n"));
	TEST_ASSERT_NULL(strstr((char *)data[id], "present"));
}

static void test_errors_are_those_of_the_contract(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "nonsense"), NULL));
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "temperature.0"), NULL));
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_READ, "/28.AABBCCDDEEFF/temperature", NULL));
	TEST_ASSERT_EQUAL_INT(-EACCES, result(BUS_WRITE, of(slave, "temperature"), "1"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, of(slave, "templow"), "abc"));
	TEST_ASSERT_EQUAL_INT(-EISDIR, result(BUS_READ, name_of(slave), NULL));
	TEST_ASSERT_EQUAL_INT(-ENOTDIR, result(BUS_DIR, of(slave, "temperature"), NULL));
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_PROBE, "/28.AABBCCDDEEFF", NULL));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_PROBE, name_of(slave), NULL));
}

static void test_an_alias_names_the_device(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	expect(true, of(slave, "alias"), "");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "alias"), "boiler"));
	expect(true, "/boiler/alias", "boiler");
	expect(true, "/boiler/id", "01005DDF0300");
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, of(slave, "alias"), "a/b"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, of(slave, "alias"), "bus.0"));
	expect(true, of(slave, "alias"), "boiler");
}

/* SmartHomeNG ends each with a NUL, a program for Windows with CR LF. */
static void test_the_end_of_a_line_or_string_behind_a_value_does_not_count(void)
{
	static const char *const ends[] = {"", "\n", "\r\n", " "};
	static const struct {
		const char *name, *value, *text;
	} values[] = {
		{"alias", "boiler", "boiler"},
		{"alias", "  Bath room", "Bath room"},
		{"templow", "-9", "          -9"},
		{"/settings/units/temperature_scale", "F", "F"},
		{"/settings/units/pressure_scale", "psi", "psi"},
		{"/settings/timeout/stable", "77", "          77"},
		{"/settings/alias/unaliased", "1", "1"},
	};

	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++)
		for (size_t n = 0; n < 2 * sizeof(ends) / sizeof(ends[0]); n++) {
			const char *path = values[i].name[0] == '/' ? values[i].name
			                                            : of(slave, values[i].name);
			char text[40];

			snprintf(text, sizeof(text), "%s%s", values[i].value, ends[n / 2]);
			write_nuls = n % 2;
			uint32_t id = ask(BUS_WRITE, BUS_INPUT, true, path, text);
			TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, path);
			TEST_ASSERT_EQUAL_UINT(strlen(text) + write_nuls, answer_to(id)->len);
			write_nuls = 0;
			expect(true, path, values[i].text);
			forget();
		}
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "alias"), " "));
	expect(true, of(slave, "alias"), "");
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, of(slave, "alias"), "a\rb"));
}

static void value_at(const char *path, char text[64])
{
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, path, NULL);

	snprintf(text, 64, "%d %.*s", answer_to(id)->err, (int)answer_to(id)->len,
	         (char *)data[id]);
}

/* Is it taken? As another was before, what is read then is what was written. */
static bool is_written_alike(const char *path, double number, double other)
{
	char text[64], before[64], as_text[64], as_number[64];
	int err;

	snprintf(text, sizeof(text), "%.15g", number);
	snprintf(before, sizeof(before), "%.15g", other);
	result(BUS_WRITE, path, before);
	err = result(BUS_WRITE, path, text);
	value_at(path, as_text);
	result(BUS_WRITE, path, before);

	uint32_t id = ask(BUS_WRITE, BUS_INPUT, true, path, "");

	req[id].number = true;
	req[id].value = number;
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, answer_to(id)->err, path);
	value_at(path, as_number);
	if (!err)
		TEST_ASSERT_EQUAL_STRING_MESSAGE(as_text, as_number, path);
	forget();
	return !err;
}

static void test_a_number_is_written_as_its_text_is(void)
{
	static const double numbers[] = {0,   1,   2,  5,    0.5,  21.5,
	                                 255, 256, -9, -0.0, 1e30, 4294967295.0};
	static const struct {
		const char *chip, *name;
		unsigned taken; /* of the numbers */
	} values[] = {
		{"DS2408", "PIO.0", 3},         {"DS2408", "PIO.BYTE", 6}, {"DS2408", "PIO.ALL", 0},
		{"DS2408", "set_alarm", 4},     {"DS18B20", "templow", 8}, {"DS18B20", "alias", 12},
		{"DS2431", "pages/page.0", 12}, {"DS2438", "date", 0},     {"DS2438", "udate", 8},
	};
	const size_t n = sizeof(numbers) / sizeof(numbers[0]);
	struct sim_slave *slaves[sizeof(values) / sizeof(values[0])];

	wire_init(&host, 1, 1);
	for (unsigned i = 0; i < sizeof(values) / sizeof(values[0]); i++)
		slaves[i] = wire_add(0, values[i].chip, i + 1);
	start();
	for (unsigned i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
		unsigned taken = 0;

		for (size_t k = 0; k < n; k++)
			taken += is_written_alike(of(slaves[i], values[i].name), numbers[k],
			                          numbers[(k + 1) % n]);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(values[i].taken, taken, values[i].name);
	}
}

/* 1.2 as a float is 1.2000000477, which a chip that counts tenths would refuse. */
static void test_a_float_is_written_as_its_shortest_text_is(void)
{
	struct sim_slave *slave;
	uint32_t id;

	wire_init(&host, 1, 1);
	slave = wire_add(0, "DS18B20", 1);
	start();
	id = ask(BUS_WRITE, BUS_INPUT, true, of(slave, "templow"), "");
	req[id].number = req[id].single = true;
	req[id].value = 1.2F;
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT(3, answer_to(id)->len);
	TEST_ASSERT_EQUAL_MEMORY("1.2", data[id], 3);
	forget();
}

static void test_structure_states_the_properties(void)
{
	wire_init(&host, 1, 1);
	start();
	expect(true, "/structure/28/temperature12", "t,000000,000001,ro,000012,v,");
	expect(true, "/structure/28/templow", "t,000000,000001,rw,000012,s,");
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, "/structure/28/nonsense", NULL));
	uint32_t id = ask(BUS_DIR, BUS_INPUT, false, "/structure/28/errata", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING(
		"/structure/28/errata/die\n/structure/28/errata/trim\n"
		"/structure/28/errata/trimblanket\n/structure/28/errata/trimvalid\n",
		(char *)data[id]);
}

/* Of what stands in the place of a device, and of nothing else. */
static void test_the_case_of_a_prefix_does_not_count(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);
	char path[64];

	start();
	for (const char *const *prefix =
	             (const char *const[]){"Uncached", "BUS.0", "Bus.0/UnCached", "Text", "ALARM",
	                                   NULL};
	     *prefix; prefix++) {
		snprintf(path, sizeof(path), "/%s%s", *prefix, of(slave, "type"));
		expect(true, path, "DS18B20");
	}
	expect(true, "/Settings/units/temperature_scale", "C");
	expect(true, "/STRUCTURE/28/templow", "t,000000,000001,rw,000012,s,");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_DIR, "/Structure/28", NULL));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_DIR, "/Bus.0/Interface", NULL));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/Simultaneous/temperature", "1"));
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, "/settings/Units/temperature_scale", NULL));
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "Type"), NULL));
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, of(slave, "alias"), "Uncached"));
}

static void test_structure_has_a_branch_as_a_file(void)
{
	static const char *const branches[] = {"/structure/12/aux", "/structure/1F/aux",
	                                       "/structure/1F/main"};

	wire_init(&host, 1, 1);
	start();
	for (size_t i = 0; i < sizeof(branches) / sizeof(branches[0]); i++) {
		expect(true, branches[i], "D,000000,000001,oo,000008,v,");
		TEST_ASSERT_EQUAL_INT(-ENOTDIR, result(BUS_DIR, branches[i], NULL));
		TEST_ASSERT_EQUAL_INT(0, result(BUS_PROBE, branches[i], NULL));
	}
	TEST_ASSERT_EQUAL_INT(-EISDIR, result(BUS_READ, "/structure/12/TAI8570", NULL));
}

static void test_structure_lists_the_first_element_of_an_array_and_reads_all(void)
{
	wire_init(&host, 1, 1);
	start();
	uint32_t id = ask(BUS_DIR, BUS_INPUT, false, "/structure/21/log", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING("/structure/21/log/date.ALL\n/structure/21/log/date.0\n"
	                         "/structure/21/log/elements\n/structure/21/log/temperature.ALL\n"
	                         "/structure/21/log/temperature.0\n/structure/21/log/udate.ALL\n"
	                         "/structure/21/log/udate.0\n",
	                         (char *)data[id]);
	id = ask(BUS_DIR, BUS_INPUT, false, "/structure/12", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_NOT_NULL(strstr((char *)data[id], "PIO.BYTE\n/structure/12/PIO.ALL\n"
	                                              "/structure/12/PIO.A\n/structure/12/T8A\n"));
	expect(true, "/structure/21/log/date.2047", "d,002047,002048,ro,000024,v,");
	expect(true, "/structure/12/PIO.B", "y,000001,000002,rw,000001,s,");
}

static void test_a_request_past_its_deadline_is_void_or_in_progress(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	host_run(&host, bus, host.now + HOST_S);
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);
	req[id].deadline_ns = host.now;
	TEST_ASSERT_EQUAL_INT(-ETIME, answer_to(id)->err);
	id = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);
	req[id].deadline_ns = host.now + 300 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(-EINPROGRESS, answer_to(id)->err);
}

static void test_what_channels_share_is_counted_once(void)
{
	wire_init(&host, 8, 1);
	wire_net.shared = (struct link_master_cost){.transfers = 5, .syscalls = 7};
	start();
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT64(wire_net.cost.wire_ns / 1000, counted("wire_us"));
	TEST_ASSERT_EQUAL_UINT64(5, counted("i2c_transfers"));
	TEST_ASSERT_EQUAL_UINT64(7, counted("syscalls"));
}

static void test_a_target_without_its_file_is_refused_with_the_reason(void)
{
	struct bus *none = NULL;
	char why[200] = "";

	wire_init(&host, 1, 1);
	TEST_ASSERT_LESS_THAN_INT(
		0, bus_create("sim:/nowhere/at/all", &host.env, &none, why, sizeof(why)));
	TEST_ASSERT_NULL(none);
	TEST_ASSERT_NOT_NULL(strstr(why, "/nowhere/at/all"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_thermometer_is_found_and_read);
	RUN_TEST(test_no_property_of_a_device_that_was_never_seen_is_there);
	RUN_TEST(test_the_listing_has_devices_and_directories);
	RUN_TEST(test_errors_are_those_of_the_contract);
	RUN_TEST(test_an_alias_names_the_device);
	RUN_TEST(test_the_end_of_a_line_or_string_behind_a_value_does_not_count);
	RUN_TEST(test_a_number_is_written_as_its_text_is);
	RUN_TEST(test_a_float_is_written_as_its_shortest_text_is);
	RUN_TEST(test_structure_states_the_properties);
	RUN_TEST(test_the_case_of_a_prefix_does_not_count);
	RUN_TEST(test_structure_has_a_branch_as_a_file);
	RUN_TEST(test_structure_lists_the_first_element_of_an_array_and_reads_all);
	RUN_TEST(test_a_request_past_its_deadline_is_void_or_in_progress);
	RUN_TEST(test_what_channels_share_is_counted_once);
	RUN_TEST(test_a_target_without_its_file_is_refused_with_the_reason);
	return UNITY_END();
}
