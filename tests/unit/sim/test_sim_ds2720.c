/* SPDX-License-Identifier: MIT */
/* DS2720: its registers, its EEPROM and the locks do what the data sheet says. */
#include "unity.h"

#include "tests/unit/aid/hand.h"

static struct hand hand;
static struct sim_slave *slave;

void setUp(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds2720, 1);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static uint8_t byte_at(uint8_t at)
{
	hand_skip(&hand, 2, 0x69, at);
	return hand_byte(&hand);
}

static void put(uint8_t at, uint8_t byte)
{
	hand_skip(&hand, 3, 0x6C, at, byte);
}

static void command(uint8_t code, uint8_t at)
{
	hand_skip(&hand, 2, code, at);
	hand.now += 11 * HAND_MS;
}

static void condition(const char *name, double level)
{
	sim_slave_advance(slave, hand.now);
	slave->input[sim_slave_input(slave, name)] = sim_constant(level);
	hand.now += HAND_MS;
}

static void test_a_condition_sets_its_flag_until_the_host_clears_it(void)
{
	static const struct {
		const char *name;
		uint8_t flag, while_set;
	} conditions[] = {{"overvoltage", 0x80, 0x87},
	                  {"undervoltage", 0x40, 0x4B},
	                  {"overcurrent", 0x10, 0x1B}};

	TEST_ASSERT_EQUAL_HEX8(0x0F, byte_at(0));
	for (unsigned i = 0; i < 3; i++) {
		condition(conditions[i].name, 1);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(conditions[i].while_set, byte_at(0),
		                               conditions[i].name);
		put(0, 0x03);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(conditions[i].while_set, byte_at(0), "it lasts");
		condition(conditions[i].name, 0);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(conditions[i].while_set, byte_at(0), "it is kept");
		put(0, 0x03);
		TEST_ASSERT_EQUAL_HEX8(0x0F, byte_at(0));
		put(0, conditions[i].flag | 0x03);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x0F, byte_at(0), "no host sets it");
	}
	put(0, 0x02);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x0A, byte_at(0), "the pins follow the enables");
}

/* "Special feature register format" */
static void test_overtemperature_and_the_ps_pin_leave_their_mark(void)
{
	TEST_ASSERT_EQUAL_HEX8(0x80, byte_at(8));
	condition("ps", 0);
	condition("ps", 1);
	TEST_ASSERT_EQUAL_HEX8(0x00, byte_at(8));
	put(8, 0x80);
	TEST_ASSERT_EQUAL_HEX8(0x80, byte_at(8));
	condition("overtemperature", 1);
	condition("overtemperature", 0);
	TEST_ASSERT_EQUAL_HEX8(0x81, byte_at(8));
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x03, byte_at(0), "both FETs are off");
	put(8, 0x80);
	TEST_ASSERT_EQUAL_HEX8(0x0F, byte_at(0));
	put(8, 0);
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8(0x80, byte_at(8));
}

static void test_what_is_written_is_in_the_shadow_until_it_is_copied(void)
{
	hand_skip(&hand, 4, 0x6C, 0x22, 0x11, 0x12);
	put(0x24, 0x13); /* after the block there is nothing */
	TEST_ASSERT_EQUAL_HEX8(0x11, byte_at(0x22));
	TEST_ASSERT_EQUAL_HEX8(0x00, byte_at(0x24));
	command(0xB8, 0x20);
	TEST_ASSERT_EQUAL_HEX8(0x00, byte_at(0x22));
	hand_skip(&hand, 4, 0x6C, 0x22, 0x11, 0x12);
	hand_skip(&hand, 2, 0x48, 0x20);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x80, byte_at(7), "it is copied");
	put(0x22, 0x55);
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0x00, byte_at(7));
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8(0x11, byte_at(0x22));
	TEST_ASSERT_EQUAL_HEX8(0x12, byte_at(0x23));
}

static void test_a_block_is_locked_for_good_by_the_bit_and_the_command_that_follows_it(void)
{
	command(0x6A, 0x30);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x00, byte_at(7), "without the bit");
	put(7, 0x40);
	TEST_ASSERT_EQUAL_HEX8(0x00, byte_at(7)); /* the read took it away */
	command(0x6A, 0x30);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x00, byte_at(7), "another command came between");
	put(0x31, 0x77);
	command(0x48, 0x30);
	put(7, 0x40);
	command(0x6A, 0x30);
	TEST_ASSERT_EQUAL_HEX8(0x02, byte_at(7));
	put(0x31, 0x78);
	put(0x21, 0x79);
	TEST_ASSERT_EQUAL_HEX8(0x77, byte_at(0x31));
	TEST_ASSERT_EQUAL_HEX8(0x79, byte_at(0x21));
	put(7, 0x00);
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8(0x02, byte_at(7));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_condition_sets_its_flag_until_the_host_clears_it);
	RUN_TEST(test_overtemperature_and_the_ps_pin_leave_their_mark);
	RUN_TEST(test_what_is_written_is_in_the_shadow_until_it_is_copied);
	RUN_TEST(test_a_block_is_locked_for_good_by_the_bit_and_the_command_that_follows_it);
	return UNITY_END();
}
