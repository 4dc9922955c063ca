/* SPDX-License-Identifier: MIT */
/* What an answer says of its device and of itself: identity, supply, retries, time of the wire. */
#include <string.h>

#include "hal/owfs/path.h"
#include "unity.h"

#include "tests/unit/aid/native_scene.h"

static struct trouble trouble;

void setUp(void)
{
	native_begin();
	wire_init(&host, 1, 1);
	trouble_none(&trouble);
	wire_net.trouble = &trouble;
}

void tearDown(void)
{
	native_end();
}

static const struct bus_answer *reading(const struct sim_slave *slave, const char *property)
{
	const struct bus_answer *answer = answer_to(
		ask(BUS_READ, BUS_INPUT, true, of(slave, property), NULL));

	TEST_ASSERT_EQUAL_INT(0, answer->err);
	return answer;
}

static struct sim_slave *add(const char *chip, const uint8_t id[6])
{
	struct sim_slave *slave = wire_add(0, chip, 1);

	memcpy(slave->rom + 1, id, 6);
	slave->rom[7] = rom_crc8(slave->rom, 7);
	wire_set(slave, "temperature", 21.4375);
	return slave;
}

static struct sim_slave *add_clone(void)
{
	static const uint8_t id[] = {0xaa, 0x3c, 0x61, 0x55, 0x14, 0x01};

	return add("DS18B20-B1", id);
}

static void test_a_reading_says_which_clone_it_is_of(void)
{
	static const uint8_t id[] = {0xca, 0xd6, 0x10, 0x10, 0, 0};
	struct sim_slave *clone = add_clone(), *genuine = add("DS18B20", id);

	start();
	TEST_ASSERT_NULL(reading(clone, "power")->identity);
	TEST_ASSERT_EQUAL_STRING("DS18B20 clone, family B1",
	                         reading(clone, "temperature")->identity);
	TEST_ASSERT_EQUAL_STRING("DS18B20", reading(genuine, "temperature")->identity);
}

static void test_a_result_that_is_the_same_in_all_takes_nothing_back(void)
{
	struct sim_slave *clone = add_clone();

	wire_set(clone, "temperature", 21.25);
	start();
	TEST_ASSERT_EQUAL_STRING("DS18B20 clone", reading(clone, "temperature")->identity);
	wire_set(clone, "temperature", 21.4375);
	TEST_ASSERT_EQUAL_STRING("DS18B20 clone, family B1",
	                         reading(clone, "temperature")->identity);
	wire_set(clone, "temperature", 21.25);
	TEST_ASSERT_EQUAL_STRING("DS18B20 clone, family B1",
	                         reading(clone, "temperature")->identity);
	TEST_ASSERT_EQUAL_STRING("DS18B20 clone, family B1",
	                         reading(clone, "temperature9")->identity);
}

static void test_chips_that_share_a_code_are_told_apart(void)
{
	struct sim_slave *battery = wire_add(0, "DS2438", 1), *warm = wire_add(0, "TMP1826", 2),
			 *relays = wire_add(0, "DS2408", 3);

	start();
	TEST_ASSERT_EQUAL_STRING("DS2438", reading(battery, "temperature")->identity);
	TEST_ASSERT_EQUAL_STRING("TMP1826", reading(warm, "temperature")->identity);
	TEST_ASSERT_EQUAL_STRING("DS2408", reading(relays, "sensed.BYTE")->identity);
}

static void test_a_reading_says_which_supply_its_chip_has(void)
{
	struct sim_slave *fed = wire_add(0, "DS18B20", 1), *other = wire_add(0, "DS18B20", 2);

	fed->parasite = true;
	start();
	TEST_ASSERT_EQUAL_UINT8(BUS_SUPPLY_UNKNOWN, reading(fed, "scratchpad")->supply);
	TEST_ASSERT_EQUAL_UINT8(BUS_SUPPLY_PARASITE, reading(fed, "temperature")->supply);
	TEST_ASSERT_EQUAL_UINT8(BUS_SUPPLY_EXTERNAL, reading(other, "temperature")->supply);
}

static void test_each_error_that_was_made_good_is_a_retry(void)
{
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);
	uint32_t slots;

	start();
	reading(slave, "temperature");
	trouble_none(&trouble);
	TEST_ASSERT_EQUAL_UINT8(0, reading(slave, "scratchpad")->retries);
	slots = trouble.slots;
	trouble_none(&trouble);
	trouble.kind = TROUBLE_TURN;
	trouble.at = slots - 1;
	trouble.mask = 1;
	TEST_ASSERT_EQUAL_UINT8(1, reading(slave, "scratchpad")->retries);
	TEST_ASSERT_EQUAL_UINT8(0, reading(slave, "scratchpad")->retries);
}

static void test_what_failed_for_good_says_how_often_it_was_tried_again(void)
{
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);
	const struct bus_answer *answer;

	start();
	reading(slave, "temperature");
	trouble_none(&trouble);
	trouble.kind = TROUBLE_NOISE;
	trouble.random = 1;
	trouble.probability = 0.3;
	answer = answer_to(ask(BUS_READ, BUS_INPUT, true, of(slave, "scratchpad"), NULL));
	TEST_ASSERT_NOT_EQUAL(0, answer->err);
	TEST_ASSERT_GREATER_THAN_UINT8(0, answer->retries);
}

/* Command, id, nine bytes: that at least; and no more than the whole bus took meanwhile. */
static void test_an_answer_has_the_time_that_its_own_slots_took(void)
{
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);
	uint64_t before, once, twice;

	start();
	reading(slave, "temperature");
	before = counted("wire_us");
	trouble_none(&trouble);
	once = reading(slave, "scratchpad")->wire_us;
	TEST_ASSERT_GREATER_OR_EQUAL_UINT64(19 * 8 * 60, once);
	TEST_ASSERT_LESS_OR_EQUAL_UINT64(counted("wire_us") - before, once);
	trouble.kind = TROUBLE_TURN;
	trouble.at = trouble.slots + trouble.slots - 1;
	trouble.mask = 1;
	twice = reading(slave, "scratchpad")->wire_us;
	TEST_ASSERT_UINT64_WITHIN(once / 10, 2 * once, twice);
}

static void test_what_asks_no_chip_takes_no_time_of_the_wire(void)
{
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	reading(slave, "temperature");
	TEST_ASSERT_EQUAL_UINT32(0, reading(slave, "family")->wire_us);
}

static void test_each_wire_counts_its_errors(void)
{
	struct sim_slave *slave;

	wire_init(&host, 3, 1);
	wire_net.trouble = &trouble;
	slave = wire_add(1, "DS18B20", 1);
	wire_add(0, "DS18B20", 2);
	start();
	reading(slave, "temperature");
	TEST_ASSERT_EQUAL_UINT64(3, counted("wires"));
	TEST_ASSERT_EQUAL_UINT64(0, counted("wire_1_errors"));
	trouble_none(&trouble);
	trouble.kind = TROUBLE_TURN;
	trouble.at = 100;
	trouble.mask = 1;
	reading(slave, "scratchpad");
	TEST_ASSERT_EQUAL_UINT64(1, counted("wire_1_errors"));
	TEST_ASSERT_EQUAL_UINT64(0, counted("wire_0_errors") + counted("wire_2_errors"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_reading_says_which_clone_it_is_of);
	RUN_TEST(test_a_result_that_is_the_same_in_all_takes_nothing_back);
	RUN_TEST(test_chips_that_share_a_code_are_told_apart);
	RUN_TEST(test_a_reading_says_which_supply_its_chip_has);
	RUN_TEST(test_each_error_that_was_made_good_is_a_retry);
	RUN_TEST(test_what_failed_for_good_says_how_often_it_was_tried_again);
	RUN_TEST(test_an_answer_has_the_time_that_its_own_slots_took);
	RUN_TEST(test_what_asks_no_chip_takes_no_time_of_the_wire);
	RUN_TEST(test_each_wire_counts_its_errors);
	return UNITY_END();
}
