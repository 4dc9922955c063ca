/* SPDX-License-Identifier: MIT */
/* One read of a register serves all who ask for its fields: the transactions are counted. */
#include <stdio.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/field.h"
#include "hal/chips/find.h"
#include "tests/unit/aid/native_scene.h"
#include "unity.h"

static struct sim_slave *chip;
static uint64_t before;

void setUp(void)
{
	native_begin();
	wire_init(&host, 1, 1);
}

void tearDown(void)
{
	native_end();
}

static void begin(const char *name)
{
	chip = wire_add(0, name, 1);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	before = wire_net.wire[0].resets;
}

/* Transactions since the last look. */
static unsigned transactions(void)
{
	uint64_t resets = wire_net.wire[0].resets, n = resets - before;

	before = resets;
	return (unsigned)n;
}

/* Ask for all elements at once, and wait for all answers. */
static void ask_eight(bool fresh, const char *property)
{
	uint32_t id[8];
	char path[40];

	for (unsigned i = 0; i < 8; i++) {
		snprintf(path, sizeof(path), "%s.%u", property, i);
		id[i] = ask(BUS_READ, BUS_GUEST, fresh, of(chip, path), NULL);
	}
	for (unsigned i = 0; i < 8; i++)
		TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
}

static void test_eight_bits_asked_for_at_once_are_one_visit(void)
{
	begin("DS2408");
	ask_eight(false, "PIO");
	TEST_ASSERT_EQUAL_UINT(1, transactions());
	ask_eight(true, "PIO");
	TEST_ASSERT_EQUAL_UINT(1, transactions());
}

static void test_registers_that_were_read_serve_their_other_fields_within_their_life(void)
{
	begin("DS2408");
	expect(false, of(chip, "PIO.0"), "0");
	TEST_ASSERT_EQUAL_UINT(1, transactions());
	ask_eight(false, "sensed");
	ask_eight(false, "latch");
	expect(false, of(chip, "power"), "1");
	expect(false, of(chip, "set_alarm"), "           0");
	TEST_ASSERT_EQUAL_UINT(0, transactions());
}

static void test_a_value_is_never_older_than_its_life(void)
{
	begin("DS2408");
	expect(false, of(chip, "PIO.0"), "0");
	wire_set(chip, "pin.0", 0);
	int64_t read_ns = host.now;

	host_run(&host, bus, host.now + 1500 * HOST_MS);
	uint32_t id = ask(BUS_READ, BUS_GUEST, false, of(chip, "sensed.0"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING("1", (char *)data[id]);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(read_ns, answer_to(id)->measured_ns);
	/* Another field is as old as the registers, and so is what is kept of the first. */
	host_run(&host, bus, host.now + 700 * HOST_MS);
	expect(false, of(chip, "sensed.0"), "0");
	expect(false, of(chip, "sensed.1"), "1");
}

static void test_a_list_is_as_old_as_its_oldest_element(void)
{
	size_t size;

	begin("DS2431");
	uint8_t *memory = sim_slave_memory(chip, &size);

	memset(memory, 'a', size);
	TEST_ASSERT_EQUAL_INT(
		0, answer_to(ask(BUS_READ, BUS_GUEST, false, of(chip, "pages/page.0"), NULL))->err);
	int64_t read_ns = host.now;

	memset(memory, 'b', size);
	host_run(&host, bus, host.now + 1500 * HOST_MS);
	uint32_t id = ask(BUS_READ, BUS_GUEST, false, of(chip, "pages/page.ALL"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT8('a', data[id][0]);
	TEST_ASSERT_EQUAL_UINT8('b', data[id][32]);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(read_ns, answer_to(id)->measured_ns);
	TEST_ASSERT_TRUE(answer_to(id)->detail & BUS_DETAIL_CACHED);
	host_run(&host, bus, host.now + 700 * HOST_MS);
	id = ask(BUS_READ, BUS_GUEST, false, of(chip, "pages/page.ALL"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT8('b', data[id][0]);
}

static void test_an_uncached_request_gets_nothing_from_before_it_came(void)
{
	begin("DS2408");
	expect(true, of(chip, "sensed.0"), "1");
	wire_set(chip, "pin.0", 0);
	transactions();
	expect(true, of(chip, "sensed.0"), "0");
	TEST_ASSERT_EQUAL_UINT(1, transactions());
}

static void test_what_was_read_before_a_write_serves_nobody_after_it(void)
{
	begin("DS2408");
	expect(false, of(chip, "PIO.BYTE"), "           0");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, "PIO.3"), "1"));
	expect(false, of(chip, "PIO.BYTE"), "           8");
	expect(false, of(chip, "sensed.3"), "0");
	expect(false, of(chip, "PIO.3"), "1");
}

static void test_requests_around_a_write_are_answered_with_what_was_true_then(void)
{
	begin("DS2408");
	uint32_t first = ask(BUS_READ, BUS_GUEST, true, of(chip, "PIO.1"), NULL);
	uint32_t write = ask(BUS_WRITE, BUS_GUEST, true, of(chip, "PIO.1"), "1");
	uint32_t second = ask(BUS_READ, BUS_GUEST, true, of(chip, "PIO.1"), NULL);

	TEST_ASSERT_EQUAL_INT(0, answer_to(first)->err);
	TEST_ASSERT_EQUAL_INT(0, answer_to(write)->err);
	TEST_ASSERT_EQUAL_INT(0, answer_to(second)->err);
	TEST_ASSERT_EQUAL_STRING("0", (char *)data[first]);
	TEST_ASSERT_EQUAL_STRING("1", (char *)data[second]);
}

static void test_what_was_read_before_a_restart_or_a_loss_serves_nobody_after_it(void)
{
	begin("DS2408");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, "PIO.BYTE"), "255"));
	expect(false, of(chip, "PIO.0"), "1");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, "por"), "0"));
	sim_slave_brownout(chip, wire_time());
	/* The read that finds the restart is not kept. */
	(void)result(BUS_READ, of(chip, "sensed.BYTE"), NULL);
	transactions();
	expect(false, of(chip, "PIO.1"), "0");
	TEST_ASSERT_GREATER_THAN_UINT(0, transactions());
}

static int64_t measured(const char *property)
{
	uint32_t id = ask(BUS_READ, BUS_GUEST, false, of(chip, property), NULL);

	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	return answer_to(id)->measured_ns;
}

static void test_what_was_read_before_a_write_that_fails_serves_nobody_after_it(void)
{
	begin("DS2408");
	for (int ms = 10; ms < 30; ms++) {
		expect(false, of(chip, "PIO.3"), "0");
		uint32_t id = ask(BUS_WRITE, BUS_GUEST, true, of(chip, "PIO.3"), "1");
		req[id].deadline_ns = host.now + ms * HOST_MS;
		answer_to(id);
		id = ask(BUS_READ, BUS_GUEST, false, of(chip, "PIO.3"), NULL);
		uint32_t now = ask(BUS_READ, BUS_GUEST, true, of(chip, "PIO.3"), NULL);
		answer_to(id);
		answer_to(now);
		TEST_ASSERT_EQUAL_STRING((char *)data[now], (char *)data[id]);
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, "PIO.BYTE"), "0"));
		forget();
	}
}

static void test_what_was_read_before_all_convert_at_once_serves_nobody_after_it(void)
{
	begin("DS18B20");
	wire_set(chip, "temperature", 20);
	expect(false, of(chip, "temperature"), "          20");
	expect(false, of(chip, "latesttemp"), "          20");
	wire_set(chip, "temperature", 30);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/simultaneous/temperature", "1"));
	host_run(&host, bus, host.now + 800 * HOST_MS);
	expect(false, of(chip, "latesttemp"), "          30");
	expect(false, of(chip, "temperature"), "          30");
}

static void test_volts_from_before_all_convert_at_once_serve_nobody_after_it(void)
{
	begin("DS2450");
	wire_set(chip, "volt.A", 1);
	expect(false, of(chip, "volt.A"), "     1.00002");
	expect(false, of(chip, "latestvolt.A"), "     1.00002");
	wire_set(chip, "volt.A", 3);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/simultaneous/voltage", "1"));
	host_run(&host, bus, host.now + 20 * HOST_MS);
	expect(false, of(chip, "latestvolt.A"), "     3.00005");
}

static void test_a_conversion_serves_no_longer_than_a_cached_value_lives(void)
{
	begin("DS18B20");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/settings/timeout/volatile", "1"));
	wire_set(chip, "temperature", 20);
	expect(false, of(chip, "temperature"), "          20");
	wire_set(chip, "temperature", 30);
	host_run(&host, bus, host.now + 1500 * HOST_MS);
	expect(false, of(chip, "temperature"), "          30");
}

static void test_a_value_of_several_parts_is_as_old_as_the_oldest(void)
{
	begin("DS2438");
	wire_set(chip, "vad", 2);
	int64_t humidity = measured("humidity");
	TEST_ASSERT_LESS_OR_EQUAL_INT64(measured("temperature"), humidity);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(measured("VAD"), humidity);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(measured("VDD"), humidity);
	int64_t page = measured("pages/page.0");
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_INT64(page, measured("pages/page.ALL"));
}

static void test_humidity_leaves_the_temperature_to_those_who_ask_next(void)
{
	begin("DS2438");
	wire_set(chip, "vad", 2);
	wire_set(chip, "temperature", 20);
	uint32_t id = ask(BUS_READ, BUS_GUEST, false, of(chip, "humidity"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_GREATER_THAN_UINT(0, transactions());
	expect(false, of(chip, "temperature"), "          20");
	id = ask(BUS_READ, BUS_GUEST, false, of(chip, "VDD"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	id = ask(BUS_READ, BUS_GUEST, false, of(chip, "HIH4000/humidity"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT(0, transactions());
	expect(true, of(chip, "temperature"), "          20");
	TEST_ASSERT_GREATER_THAN_UINT(0, transactions());
}

static void test_four_volts_asked_for_at_once_are_one_conversion(void)
{
	static const char *const volts[] = {"volt.A", "volt.B", "volt.C", "volt.D"};
	uint32_t id[4];

	begin("DS2450");
	for (int i = 0; i < 4; i++)
		id[i] = ask(BUS_READ, BUS_GUEST, true, of(chip, volts[0]), NULL);
	for (int i = 0; i < 4; i++)
		answer_to(id[i]);
	transactions();
	for (int i = 0; i < 4; i++)
		id[i] = ask(BUS_READ, BUS_GUEST, true, of(chip, volts[i]), NULL);
	for (int i = 0; i < 4; i++)
		TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
	/* The settings, the conversion, its result. */
	TEST_ASSERT_EQUAL_UINT(3, transactions());
}

/* Writes twice, the second time between the parts in which 2560 bytes are read. */
static void test_a_long_memory_that_is_written_meanwhile_is_not_half_old(void)
{
	static char text[2560];
	unsigned between = 0;

	begin("DS28EC20");
	for (unsigned moment = 0; moment < 8; moment++) {
		write_offset = 0;
		memset(text, 'a', sizeof(text));
		text[sizeof(text) - 1] = '\0';
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, "memory"), text));
		forget();
		uint32_t id = ask(BUS_READ, BUS_GUEST, true, of(chip, "memory"), NULL);

		host_run(&host, bus, host.now + (1 + moment) * 200 * HOST_MS);
		uint32_t early = ask(BUS_WRITE, BUS_INPUT, true, of(chip, "pages/page.0"), "b");

		write_offset = 31;
		uint32_t late = ask(BUS_WRITE, BUS_INPUT, true, of(chip, "pages/page.77"), "b");

		write_offset = 0;
		between += !host_answer(&host, id);
		TEST_ASSERT_EQUAL_INT(0, answer_to(early)->err);
		TEST_ASSERT_EQUAL_INT(0, answer_to(late)->err);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		/* page 0 is written first: the other is new only where that is, too */
		if (data[id][77 * 32 + 31] == 'b')
			TEST_ASSERT_EQUAL_CHAR('b', data[id][0]);
		forget();
	}
	TEST_ASSERT_GREATER_THAN_UINT(3, between);
}

/* Written at each moment between elements: what is answered then may be old, but is not kept. */
static void test_a_list_that_is_written_meanwhile_is_not_kept(void)
{
	static const struct {
		const char *chip, *list, *element, *before, *after;
		size_t at;
	} lists[] = {{"DS2438", "pages/page.ALL", "pages/page.3", "aaaaaaaa", "bbbbbbbb", 24},
	             {"DS2438", "pages/page.ALL", "pages/page.6", "aaaaaaaa", "bbbbbbbb", 48},
	             {"DS2450", "set_alarm/low.ALL", "set_alarm/low.A", "0", "1", 0},
	             {"DS2450", "PIO.ALL", "PIO.A", "0", "1", 0}};
	unsigned between = 0;

	for (size_t i = 0; i < sizeof(lists) / sizeof(lists[0]); i++)
		for (unsigned moment = 1; moment < 40; moment++) {
			tearDown();
			setUp();
			begin(lists[i].chip);
			TEST_ASSERT_EQUAL_INT(
				0, result(BUS_WRITE, of(chip, lists[i].element), lists[i].before));
			uint32_t id = ask(BUS_READ, BUS_GUEST, false, of(chip, lists[i].list),
			                  NULL);

			host_run(&host, bus, host.now + moment * 10 * HOST_MS);
			between += !host_answer(&host, id);
			TEST_ASSERT_EQUAL_INT(
				0, result(BUS_WRITE, of(chip, lists[i].element), lists[i].after));
			TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
			id = ask(BUS_READ, BUS_GUEST, false, of(chip, lists[i].list), NULL);
			TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
			TEST_ASSERT_EQUAL_CHAR_MESSAGE(lists[i].after[0], data[id][lists[i].at],
			                               lists[i].list);
		}
	TEST_ASSERT_GREATER_THAN_UINT(20, between);
}

/* What of two requests is out of one row is still found: the tables are searched by halves. */
static void test_the_properties_of_each_family_are_sorted_by_name(void)
{
	const struct family *family;

	for (unsigned n = 0; (family = family_nth(n)); n++)
		for (unsigned i = 1; i < family->count; i++)
			TEST_ASSERT_LESS_THAN_INT_MESSAGE(
				0,
				strcmp(family->properties[i - 1].name, family->properties[i].name),
				family->properties[i].name);
}

/* All elements at once are read one by one, and each of those in one part (exchange.c). */
static void test_no_array_has_elements_that_are_read_in_parts(void)
{
	const struct family *family;
	unsigned arrays = 0;

	for (unsigned n = 0; (family = family_nth(n)); n++)
		for (unsigned i = 0; i < family->count; i++) {
			const struct property *property = &family->properties[i];

			if (property->type != PROPERTY_BINARY || !property->array.count)
				continue;
			arrays++;
			TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(FIELD_CHUNK, property->size,
			                                       property->name);
		}
	TEST_ASSERT_GREATER_THAN_UINT(10, arrays);
}

static void test_the_families_are_in_the_order_of_their_codes(void)
{
	for (unsigned n = 1; family_nth(n); n++)
		TEST_ASSERT_GREATER_THAN_UINT(family_nth(n - 1)->code, family_nth(n)->code);
}

/* Chips of which one or another is always between two transactions of a measurement. */
static void test_all_convert_at_once_though_chips_are_at_work_all_the_time(void)
{
	struct sim_slave *slave[6];
	uint32_t id[6];

	for (unsigned i = 0; i < 6; i++)
		slave[i] = wire_add(0, "DS1922L", i + 1);
	wire_add(0, "DS18B20", 9);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	forget();
	for (unsigned i = 0; i < 6; i++)
		id[i] = ask(BUS_READ, BUS_INPUT, true, of(slave[i], "temperature"), NULL);
	uint32_t all = ask(BUS_WRITE, BUS_INPUT, true, "/simultaneous/temperature", "1");
	for (unsigned asked = 7; asked < NATIVE_REQUESTS - 6 && !host_answer(&host, all);) {
		host_run(&host, bus, host.now + HOST_MS);
		for (unsigned i = 0; i < 6; i++)
			if (host_answer(&host, id[i])) {
				TEST_ASSERT_EQUAL_INT(0, host_answer(&host, id[i])->err);
				id[i] = ask(BUS_READ, BUS_INPUT, true, of(slave[i], "temperature"),
				            NULL);
				asked++;
			}
	}
	TEST_ASSERT_NOT_NULL(host_answer(&host, all));
	TEST_ASSERT_EQUAL_INT(0, host_answer(&host, all)->err);
	for (unsigned i = 0; i < 6; i++)
		TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_eight_bits_asked_for_at_once_are_one_visit);
	RUN_TEST(test_registers_that_were_read_serve_their_other_fields_within_their_life);
	RUN_TEST(test_a_value_is_never_older_than_its_life);
	RUN_TEST(test_a_list_is_as_old_as_its_oldest_element);
	RUN_TEST(test_an_uncached_request_gets_nothing_from_before_it_came);
	RUN_TEST(test_what_was_read_before_a_write_serves_nobody_after_it);
	RUN_TEST(test_requests_around_a_write_are_answered_with_what_was_true_then);
	RUN_TEST(test_what_was_read_before_a_restart_or_a_loss_serves_nobody_after_it);
	RUN_TEST(test_what_was_read_before_a_write_that_fails_serves_nobody_after_it);
	RUN_TEST(test_what_was_read_before_all_convert_at_once_serves_nobody_after_it);
	RUN_TEST(test_volts_from_before_all_convert_at_once_serve_nobody_after_it);
	RUN_TEST(test_a_conversion_serves_no_longer_than_a_cached_value_lives);
	RUN_TEST(test_a_value_of_several_parts_is_as_old_as_the_oldest);
	RUN_TEST(test_humidity_leaves_the_temperature_to_those_who_ask_next);
	RUN_TEST(test_four_volts_asked_for_at_once_are_one_conversion);
	RUN_TEST(test_a_long_memory_that_is_written_meanwhile_is_not_half_old);
	RUN_TEST(test_a_list_that_is_written_meanwhile_is_not_kept);
	RUN_TEST(test_the_properties_of_each_family_are_sorted_by_name);
	RUN_TEST(test_no_array_has_elements_that_are_read_in_parts);
	RUN_TEST(test_the_families_are_in_the_order_of_their_codes);
	RUN_TEST(test_all_convert_at_once_though_chips_are_at_work_all_the_time);
	return UNITY_END();
}
