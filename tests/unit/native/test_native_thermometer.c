/* SPDX-License-Identifier: MIT */
/* Tests of conversions shared by the thermometers of a wire. */
#include <errno.h>
#include <string.h>

#include "hal/chips/find.h"
#include "hal/chips/thermometers/state.h"
#include "hal/chips/thermometers/thermometer.h"
#include "hal/owfs/path.h"
#include "hal/sim/chips/thermometer.h"
#include "unity.h"

#include "tests/unit/aid/native_scene.h"

void setUp(void)
{
	native_begin();
}

void tearDown(void)
{
	native_end();
}

static void test_one_convert_serves_all_that_are_due(void)
{
	struct sim_slave *slave[20];
	uint32_t id[20];

	wire_init(&host, 2, 2);
	for (unsigned i = 0; i < 20; i++) {
		slave[i] = wire_add(i % 2, "DS18B20", i + 1);
		wire_set(slave[i], "temperature", i + 0.5);
	}
	start();
	expect(true, of(slave[0], "power"), "1");
	wire_net.convert_count = 0;
	int64_t begun = host.now;
	for (unsigned i = 0; i < 20; i++)
		id[i] = ask(BUS_READ, BUS_INPUT, true, of(slave[i], "temperature"), NULL);
	for (unsigned i = 0; i < 20; i++) {
		const struct bus_answer *answer = answer_to(id[i]);

		TEST_ASSERT_EQUAL_INT(0, answer->err);
		TEST_ASSERT_EQUAL_DOUBLE(i + 0.5, answer->number);
		TEST_ASSERT_EQUAL_UINT8(BUS_NUMBER, answer->kind);
		TEST_ASSERT_GREATER_THAN_INT64(begun, answer->measured_ns);
	}
	TEST_ASSERT_EQUAL_UINT(2, wire_net.convert_count);
	TEST_ASSERT_LESS_THAN_INT64(begun + 1100 * HOST_MS, host.now);
}

static void test_a_chip_that_takes_the_question_otherwise_does_not_divide_the_conversion(void)
{
	struct sim_slave *slave[5];
	uint32_t id[5];

	wire_init(&host, 1, 1);
	for (unsigned i = 0; i < 5; i++)
		slave[i] = wire_add(0, "DS18B20", i + 1);
	wire_add(0, "DS2438", 9);
	start();
	for (unsigned i = 0; i < 4; i++)
		id[i] = ask(BUS_READ, BUS_INPUT, true, of(slave[i], "temperature"), NULL);
	for (unsigned i = 0; i < 4; i++)
		TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
	TEST_ASSERT_EQUAL_UINT(1, wire_net.convert_count);
}

/* A channel is asked one by one now and then: at each moment of another's conversion. */
static void test_a_conversion_that_is_not_read_yet_is_not_overwritten(void)
{
	for (int ms = 20; ms < 760; ms += 40) {
		wire_init(&host, 1, 1);
		struct sim_slave *slave = wire_add(0, "DS18B20", 1);

		wire_set(slave, "temperature", 20.5);
		start();
		expect(true, of(slave, "temperature"), "        20.5");
		/* what was converted a minute ago is due one by one */
		host_run(&host, bus, host.now + 59160 * HOST_MS);
		wire_set(slave, "temperature", 30.5);
		int64_t begun = host.now;
		uint32_t first = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);
		host_run(&host, bus, host.now + ms * HOST_MS);
		uint32_t second = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);

		TEST_ASSERT_EQUAL_DOUBLE(30.5, answer_to(first)->number);
		TEST_ASSERT_GREATER_OR_EQUAL_INT64(begun, answer_to(first)->measured_ns);
		TEST_ASSERT_EQUAL_DOUBLE(30.5, answer_to(second)->number);
		native_end();
		native_begin();
	}
	wire_init(&host, 1, 1);
	start();
}

static void test_noise_at_the_question_does_not_make_a_thermometer_fed_by_the_wire(void)
{
	struct trouble trouble;
	uint32_t slots = 1;

	for (uint32_t at = 0; at < slots; at += 3) {
		wire_init(&host, 1, 1);
		struct sim_slave *slave = wire_add(0, "DS18B20", 1),
				 *other = wire_add(0, "DS18B20", 2);

		/* it answers the question to all with zeros, so that each is asked */
		wire_add(0, "DS2438", 3);
		wire_net.trouble = &trouble;
		start();
		trouble_none(&trouble);
		trouble.kind = at ? TROUBLE_TURN : TROUBLE_NONE;
		trouble.at = at;
		trouble.mask = 1;
		result(BUS_READ, of(slave, "temperature"), NULL);
		if (!at)
			slots = trouble.slots;
		trouble_none(&trouble);
		wire_net.strong_count = 0;
		TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(other, "temperature"), NULL));
		TEST_ASSERT_EQUAL_UINT_MESSAGE(0, wire_net.strong_count, "pulled up");
		wire_net.trouble = NULL;
		native_end();
		native_begin();
	}
	wire_init(&host, 1, 1);
	start();
}

static const struct sim_slave *unheard; /* the next question for its supply fails ... */
static int fails_with;

static void fail_question(const uint8_t *bytes, size_t n)
{
	if (!unheard || n != 10 || bytes[9] != 0xb4 || memcmp(bytes + 1, unheard->rom, 8) != 0)
		return;
	unheard = NULL;
	wire_net.fault = fails_with;
	wire_net.fault_count = 1;
}

/* What counts as fed by the wire because its question failed is asked before it converts. */
static void test_an_error_at_the_question_does_not_make_a_thermometer_fed_by_the_wire(void)
{
	static const int errors[] = {-EIO, -ECOMM, -ENXIO};

	for (unsigned i = 0; i < 6; i++) {
		wire_init(&host, 1, 1);
		wire_net.passive = i & 1;
		struct sim_slave *slave = wire_add(0, "DS18B20", 1),
				 *other = wire_add(0, "DS18B20", 2);

		wire_add(0, "DS2438", 3);
		wire_set(other, "temperature", 30.5);
		wire_net.sends = fail_question;
		start();
		unheard = other;
		fails_with = errors[i / 2];
		TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(slave, "temperature"), NULL));
		TEST_ASSERT_NULL(unheard);
		/* That it is fed by the wire, nobody knows. */
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(other, "temphigh"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_UINT8(BUS_SUPPLY_UNKNOWN, answer_to(id)->supply);
		wire_net.strong_count = 0;
		id = ask(BUS_READ, BUS_INPUT, true, of(other, "temperature"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_DOUBLE(30.5, answer_to(id)->number);
		TEST_ASSERT_EQUAL_UINT8(BUS_SUPPLY_EXTERNAL, answer_to(id)->supply);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(0, wire_net.strong_count, "pulled up");
		native_end();
		native_begin();
	}
	wire_init(&host, 1, 1);
	start();
}

static void test_parasites_get_the_strong_pull_up_for_the_whole_conversion(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	slave->parasite = true;
	wire_set(slave, "temperature", -10.5);
	start();
	expect(true, of(slave, "temperature"), "       -10.5");
	expect(true, of(slave, "power"), "0");
	/* The first reading is made twice: whether the chip heard cannot be seen otherwise. */
	TEST_ASSERT_EQUAL_UINT(2, wire_net.strong_count);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(750 * HOST_MS, wire_net.strong_ns);
}

static void test_limits_are_stored_with_the_resolution_that_was_there(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 20.3125);
	start();
	expect(true, of(slave, "temperature9"), "          20");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "temphigh"), "30"));
	expect(true, of(slave, "temphigh"), "          30");
	expect(true, of(slave, "tempres"), "          12");
	sim_slave_power_on(slave, wire_time());
	expect(true, of(slave, "temphigh"), "          30");
	expect(true, of(slave, "temperature"), "     20.3125");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "tempres"), "10"));
	expect(true, of(slave, "temperature"), "       20.25");
	expect(true, of(slave, "tempres"), "          10");
}

static unsigned settings_sent, settings_odd;

/* Match ROM, Write Scratchpad, the upper limit, ... */
static void look_at_settings(const uint8_t *bytes, size_t n)
{
	if (n != 13 || bytes[9] != 0x4e)
		return;
	settings_sent++;
	settings_odd += bytes[10] != 30;
}

/* A wire that is cut in the midst of it leaves the chip with a limit that somebody asked for. */
static void test_a_limit_on_its_way_to_the_eeprom_is_never_another(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	settings_sent = settings_odd = 0;
	wire_net.sent = look_at_settings;
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "temphigh"), "30"));
	wire_net.sent = NULL;
	TEST_ASSERT_GREATER_THAN_UINT(0, settings_sent);
	TEST_ASSERT_EQUAL_UINT(0, settings_odd);
}

static void test_a_cached_value_keeps_its_time(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 20);
	start();
	uint32_t first = ask(BUS_READ, BUS_INPUT, false, of(slave, "temperature"), NULL);
	int64_t measured = answer_to(first)->measured_ns;
	wire_set(slave, "temperature", 30);
	uint32_t second = ask(BUS_READ, BUS_INPUT, false, of(slave, "temperature"), NULL);
	TEST_ASSERT_EQUAL_DOUBLE(20, answer_to(second)->number);
	TEST_ASSERT_EQUAL_INT64(measured, answer_to(second)->measured_ns);
	TEST_ASSERT_BITS_HIGH(BUS_DETAIL_CACHED, answer_to(second)->detail);
	host_run(&host, bus, host.now + 3 * HOST_S);
	expect(false, of(slave, "temperature"), "          30");
}

static void test_a_number_is_read_without_its_text_and_the_cache_gives_both(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 20.0625);
	start();
	uint32_t id = ask(BUS_READ, BUS_INPUT, false, of(slave, "temperature"), NULL);
	req[id].number = true; /* before the bus has begun */
	TEST_ASSERT_EQUAL_DOUBLE(20.0625, answer_to(id)->number);
	TEST_ASSERT_EQUAL_UINT32(0, answer_to(id)->len);
	id = ask(BUS_READ, BUS_GUEST, false, of(slave, "temperature"), NULL);
	TEST_ASSERT_BITS_HIGH(BUS_DETAIL_CACHED, answer_to(id)->detail);
	TEST_ASSERT_EQUAL_DOUBLE(20.0625, answer_to(id)->number);
	TEST_ASSERT_EQUAL_UINT32(12, answer_to(id)->len);
	TEST_ASSERT_EQUAL_STRING("     20.0625", (char *)data[id]);
}

static void test_a_monitor_that_restarts_while_it_measures_is_measured_again(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS2438", 1);

	wire_set(slave, "temperature", 20.5);
	start();
	host_run(&host, bus, host.now + HOST_S);
	for (unsigned ms = 0; ms < 45; ms++) {
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);

		host_run(&host, bus, host.now + ms * HOST_MS);
		sim_slave_brownout(slave, wire_time());
		if (answer_to(id)->err == 0)
			TEST_ASSERT_EQUAL_DOUBLE(20.5, answer_to(id)->number);
	}
	wire_set(slave, "temperature", 0);
	expect(true, of(slave, "temperature"), "           0");
}

static void test_the_power_on_value_of_the_genuine_chip_is_known_from_the_temperature(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 84.5);
	start();
	expect(true, of(slave, "temperature"), "        84.5");
	wire_set(slave, "temperature", 85);
	expect(true, of(slave, "temperature"), "          85");
	sim_slave_power_on(slave, wire_time());
	TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(slave, "latesttemp"), NULL));
}

/* The DS1820 of the 1990s counts what a degree has; later chips have 16 for it. */
static void test_a_ds1820_with_any_count_of_a_degree_is_read(void)
{
	static const unsigned counts[] = {16, 17, 64, 78, 100, 127};

	for (unsigned i = 0; i < sizeof(counts) / sizeof(counts[0]); i++) {
		setUp();
		wire_init(&host, 1, 1);
		struct sim_slave *slave = wire_add(0, "DS18S20", 1);

		TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "counts", counts[i]));
		start();
		for (double celsius = -10; celsius < 11; celsius += 3.3125) {
			uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"),
			                  (wire_set(slave, "temperature", celsius), NULL));

			TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
			TEST_ASSERT_DOUBLE_WITHIN(1.01 / counts[i], celsius, answer_to(id)->number);
		}
		/* Whatever it left in the counts, a restart leaves 85. */
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/simultaneous/temperature", "1"));
		sim_slave_brownout(slave, wire_time());
		((struct sim_thermometer *)slave->state)->scratchpad[7] = (uint8_t)counts[i];
		TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(slave, "latesttemp"), NULL));
		tearDown();
	}
	setUp();
}

static void test_counts_of_a_degree_that_no_chip_has_are_refused(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18S20", 1);

	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "counts", 200));
	start();
	TEST_ASSERT_EQUAL_INT(-ENOMSG, result(BUS_READ, of(slave, "temperature"), NULL));
}

/* Of a clone, whose byte 6 tells nothing. */

static void test_the_power_on_value_is_never_good(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "fixed", 1));
	wire_set(slave, "temperature", 20.5);
	start();
	TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(slave, "latesttemp"), NULL));
	expect(true, of(slave, "temperature"), "        20.5");
	expect(true, of(slave, "latesttemp"), "        20.5");
	sim_slave_power_on(slave, wire_time());
	TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(slave, "latesttemp"), NULL));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_POR));
	wire_set(slave, "temperature", 85);
	TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(slave, "temperature"), NULL));
	wire_set(slave, "temperature", 84);
	expect(true, of(slave, "temperature"), "          84");
	wire_set(slave, "temperature", 85);
	expect(true, of(slave, "temperature"), "          85");
}

/* The last reading counts, and no other: of a clone, which shows nothing of a restart. */
static void test_85_is_good_near_the_last_reading_of_the_last_minute_alone(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);
	static const struct {
		double before;
		int64_t wait_s;
		bool good;
	} cases[] = {{79.9375, 0, false}, {80, 0, true},  {84, 50, true},  {84, 62, false},
	             {90, 0, true},       {95, 0, false}, {-16, 0, false}, {84, 0, true}};

	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "fixed", 1));
	wire_set(slave, "temperature", 20.5);
	start();
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		wire_set(slave, "temperature", cases[i].before);
		TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(slave, "temperature"), NULL));
		host_run(&host, bus, host.now + cases[i].wait_s * HOST_S);
		wire_set(slave, "temperature", 85);
		TEST_ASSERT_EQUAL_INT(cases[i].good ? 0 : -ERANGE,
		                      result(BUS_READ, of(slave, "temperature"), NULL));
	}
}

static void test_a_chip_that_takes_no_resolution_is_read_all_the_same(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "fixed", 1));
	wire_set(slave, "temperature", 21.0625);
	start();
	expect(true, of(slave, "temperature9"), "     21.0625");
	expect(true, of(slave, "temperature"), "     21.0625");
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, of(slave, "tempres"), "10"));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_POR));
}

static void test_one_device_serves_two_resolutions_at_once(void)
{
	static const char *const names[] = {"temperature9", "temperature12", "temperature10",
	                                    "temperature", "temperature12"};
	static const double values[] = {21, 21.0625, 21, 21.0625, 21.0625};
	uint32_t id[5];

	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 21.0625);
	start();
	for (int i = 0; i < 5; i++)
		id[i] = ask(BUS_READ, BUS_INPUT, true, of(slave, names[i]), NULL);
	for (int i = 0; i < 5; i++) {
		TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
		TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(values[i], answer_to(id[i])->number, names[i]);
	}
}

/* Nobody answers, and noise turns two bits over: the checksum of these is right. */
static void test_ones_that_noise_gave_a_right_checksum_are_no_temperature(void)
{
	uint8_t noise[9] = {0xfb, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xdf, 0xff};
	static const uint8_t codes[] = {0x10, 0x22, 0x28, 0x42};
	struct thermometer chip = {0};

	TEST_ASSERT_EQUAL_UINT8(0, rom_crc8(noise, 9));
	for (unsigned i = 0; i < sizeof(codes); i++) {
		struct device device = {.family = family_of(codes[i]), .own = &chip};
		struct txn txn = {.device = &device};

		TEST_ASSERT_EQUAL_INT(-EBADMSG, thermometer_saw(&txn, 0, noise, 9));
	}
}

static struct trouble swallowed;
static unsigned writes_lost;

/* The first Write Scratchpad. */
static void swallow(const uint8_t *bytes, size_t n)
{
	if (n < 10 || bytes[9] != 0x4e || writes_lost)
		return;
	swallowed.deaf = true;
	writes_lost++;
}

static void test_a_chip_that_did_not_hear_of_a_resolution_is_told_again(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);
	struct sim_thermometer *sim = slave->state;

	sim->eeprom[2] = sim->scratchpad[4] = 0x1f;
	wire_set(slave, "temperature", 20.3125);
	trouble_none(&swallowed);
	wire_net.trouble = &swallowed;
	wire_net.sends = swallow;
	writes_lost = 0;
	start();
	expect(true, of(slave, "temperature12"), "     20.3125");
	TEST_ASSERT_EQUAL_UINT(1, writes_lost);
	expect(true, of(slave, "temperature12"), "     20.3125");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_one_convert_serves_all_that_are_due);
	RUN_TEST(test_a_chip_that_takes_the_question_otherwise_does_not_divide_the_conversion);
	RUN_TEST(test_a_conversion_that_is_not_read_yet_is_not_overwritten);
	RUN_TEST(test_noise_at_the_question_does_not_make_a_thermometer_fed_by_the_wire);
	RUN_TEST(test_an_error_at_the_question_does_not_make_a_thermometer_fed_by_the_wire);
	RUN_TEST(test_parasites_get_the_strong_pull_up_for_the_whole_conversion);
	RUN_TEST(test_limits_are_stored_with_the_resolution_that_was_there);
	RUN_TEST(test_a_limit_on_its_way_to_the_eeprom_is_never_another);
	RUN_TEST(test_a_cached_value_keeps_its_time);
	RUN_TEST(test_a_number_is_read_without_its_text_and_the_cache_gives_both);
	RUN_TEST(test_a_monitor_that_restarts_while_it_measures_is_measured_again);
	RUN_TEST(test_the_power_on_value_of_the_genuine_chip_is_known_from_the_temperature);
	RUN_TEST(test_a_ds1820_with_any_count_of_a_degree_is_read);
	RUN_TEST(test_counts_of_a_degree_that_no_chip_has_are_refused);
	RUN_TEST(test_the_power_on_value_is_never_good);
	RUN_TEST(test_85_is_good_near_the_last_reading_of_the_last_minute_alone);
	RUN_TEST(test_a_chip_that_takes_no_resolution_is_read_all_the_same);
	RUN_TEST(test_one_device_serves_two_resolutions_at_once);
	RUN_TEST(test_ones_that_noise_gave_a_right_checksum_are_no_temperature);
	RUN_TEST(test_a_chip_that_did_not_hear_of_a_resolution_is_told_again);
	return UNITY_END();
}
