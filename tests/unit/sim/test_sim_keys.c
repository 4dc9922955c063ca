/* SPDX-License-Identifier: MIT */
/* The memories with passwords, DS1991 and DS1977: what a password opens, and what it does not. */
#include <string.h>

#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/hand.h"

static const uint8_t right[8] = {1, 2, 3, 4, 5, 6, 7, 8}, wrong[8] = {8};
static const uint8_t fresh[8] = {9, 9, 9, 9, 9, 9, 9, 9};
static struct hand hand;
static struct sim_slave *slave;

void setUp(void)
{
	hand_clear(&hand);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static uint8_t *plug(const struct sim_family *family)
{
	size_t size;

	slave = hand_plug(&hand, family, 1);
	return sim_slave_memory(slave, &size);
}

static void send(const uint8_t *bytes, unsigned n)
{
	hand_skip(&hand, 0);
	hand_write(&hand, bytes, n);
}

/* Identifier "subkey 1" and the right password in subkey 1, and a byte of data. */
static uint8_t *plug_ds1991(void)
{
	uint8_t *subkey = plug(&sim_ds1991) + 0x40;

	memcpy(subkey, "subkey 1", 8);
	memcpy(subkey + 8, right, 8);
	subkey[0x10] = 0xD0;
	return subkey;
}

/* Begin a command for subkey 1: the chip sends its identifier. */
static void begin_subkey(uint8_t code, uint8_t at)
{
	char id[9] = "";

	hand_skip(&hand, 3, code, at, ~at & 0xFF);
	hand_read(&hand, (uint8_t *)id, 8);
	TEST_ASSERT_EQUAL_STRING("subkey 1", id);
}

static void test_the_password_opens_a_subkey_and_a_wrong_one_reads_noise(void)
{
	uint8_t in[48];

	plug_ds1991();
	begin_subkey(0x66, 0x50);
	hand_write(&hand, right, 8);
	hand_read(&hand, in, sizeof(in));
	TEST_ASSERT_EQUAL_HEX8(0xD0, in[0]);
	TEST_ASSERT_EQUAL_HEX8(0x00, in[47]);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	begin_subkey(0x66, 0x50);
	hand_write(&hand, wrong, 8);
	hand_read(&hand, in, sizeof(in));
	TEST_ASSERT_NOT_EQUAL(0, memcmp(in, sim_slave_memory(slave, &(size_t){0}) + 0x50, 48));
}

static void test_a_subkey_is_written_with_its_password_only(void)
{
	uint8_t *subkey = plug_ds1991(), data = 0x5A;

	begin_subkey(0x99, 0x52);
	hand_write(&hand, wrong, 8);
	hand_write(&hand, &data, 1);
	TEST_ASSERT_EQUAL_HEX8(0x00, subkey[0x12]);
	begin_subkey(0x99, 0x52);
	hand_write(&hand, right, 8);
	hand_write(&hand, &data, 1);
	TEST_ASSERT_EQUAL_HEX8(0x5A, subkey[0x12]);
	TEST_ASSERT_EQUAL_HEX8(0xD0, subkey[0x10]);
}

static void test_an_address_without_its_complement_is_not_taken(void)
{
	plug_ds1991();
	hand_skip(&hand, 3, 0x66, 0x50, 0xAE);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

static void test_a_new_password_clears_the_data(void)
{
	uint8_t *subkey = plug_ds1991();

	begin_subkey(0x5A, 0x40);
	hand_write(&hand, wrong, 8); /* not the identifier */
	hand_write(&hand, wrong, 8);
	hand_write(&hand, wrong, 8);
	TEST_ASSERT_EQUAL_HEX8(0xD0, subkey[0x10]);
	begin_subkey(0x5A, 0x40);
	hand_write(&hand, (const uint8_t *)"subkey 1", 8);
	hand_write(&hand, (const uint8_t *)"new name", 8);
	hand_write(&hand, fresh, 8);
	TEST_ASSERT_EQUAL_HEX8_ARRAY("new name", subkey, 8);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(fresh, subkey + 8, 8);
	TEST_ASSERT_EQUAL_HEX8(0x00, subkey[0x10]);
}

static void test_the_scratchpad_replaces_a_password_and_keeps_the_data(void)
{
	static const uint8_t password_block[] = {0x9A, 0x9A, 0x4C, 0x62, 0x9B, 0x91, 0x69, 0x4C};
	uint8_t *subkey = plug_ds1991(), in[8];

	hand_skip(&hand, 3, 0x96, 0xC8, 0x37);
	hand_write(&hand, fresh, 8);
	hand_skip(&hand, 3, 0x69, 0xC8, 0x37);
	hand_read(&hand, in, 8);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(fresh, in, 8);
	hand_skip(&hand, 3, 0x3C, 0x40, 0xBF);
	hand_write(&hand, password_block, 8);
	hand_write(&hand, wrong, 8);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(right, subkey + 8, 8);
	hand_skip(&hand, 3, 0x3C, 0x40, 0xBF);
	hand_write(&hand, password_block, 8);
	hand_write(&hand, right, 8);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(fresh, subkey + 8, 8);
	TEST_ASSERT_EQUAL_HEX8(0xD0, subkey[0x10]);
}

static void test_a_ds1425_is_a_ds1991_with_its_own_code(void)
{
	plug(&sim_ds1425)[0x80] = 0x33;
	TEST_ASSERT_EQUAL_HEX8(0x82, slave->rom[0]);
	hand_skip(&hand, 3, 0x66, 0x90, 0x6F);
	TEST_ASSERT_EQUAL_HEX8(0x33, hand_byte(&hand));
}

/* Send address and password, and give the chip the current it needs. */
static void with_password(const uint8_t *head, unsigned n, const uint8_t password[8])
{
	send(head, n);
	hand_write(&hand, password, 8);
	sim_slave_strong(slave, true, hand.now);
	hand.now += 11 * HAND_MS;
	sim_slave_strong(slave, false, hand.now);
}

static void write_ds1977(uint16_t at, const uint8_t *data, unsigned n, const uint8_t password[8])
{
	uint8_t low = at & 0xFF, high = (uint8_t)(at >> 8), last = (uint8_t)((low + n - 1) & 63);
	const uint8_t copy[] = {0x99, low, high, last};

	hand_skip(&hand, 3, 0x0F, low, high);
	hand_write(&hand, data, n);
	with_password(copy, sizeof(copy), password);
}

static uint8_t read_ds1977(uint16_t at, const uint8_t password[8])
{
	uint8_t io[3 + 64 + 2] = {0x69, at & 0xFF, (uint8_t)(at >> 8)};
	unsigned n = 64 - at % 64;

	with_password(io, 3, password);
	hand_read(&hand, io + 3, n + 2);
	if (io[3] != 0xFF || io[4] != 0xFF)
		TEST_ASSERT_EQUAL_HEX16(0xB001, sim_crc16(0, io, n + 5));
	return io[3];
}

static void test_a_ds1977_reads_pages_with_a_checksum_that_leaves_out_the_password(void)
{
	uint8_t *memory = plug(&sim_ds1977);

	slave->parasite = true;
	memory[0x7F80] = 0x12;
	memory[0x1010] = 0x34;
	TEST_ASSERT_EQUAL_HEX8(0x12, read_ds1977(0x7F80, wrong));
	TEST_ASSERT_EQUAL_HEX8(0x34, read_ds1977(0x1010, wrong));
}

static void test_a_ds1977_without_strong_pull_up_reads_ones(void)
{
	uint8_t *memory = plug(&sim_ds1977);

	slave->parasite = true;
	memory[0] = 0x12;
	hand_skip(&hand, 3, 0x69, 0x00, 0x00);
	hand_write(&hand, wrong, 8);
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

static void test_passwords_of_a_ds1977_guard_once_they_are_enabled(void)
{
	static const uint8_t enable = 0xAA, verify[] = {0xC3, 0xC8, 0x7F}, data[] = {0x77, 0x78};
	uint8_t *memory = plug(&sim_ds1977);

	slave->parasite = true;
	write_ds1977(0x7FC0, right, 8, wrong);
	write_ds1977(0x7FC8, fresh, 8, wrong);
	with_password(verify, sizeof(verify), wrong);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	with_password(verify, sizeof(verify), fresh);
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	write_ds1977(0x7FD0, &enable, 1, wrong);
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	write_ds1977(0x100, data, 2, right); /* for reading only */
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x00, memory[0x100]);
	write_ds1977(0x100, data, 2, fresh);
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x77, read_ds1977(0x100, right));
	TEST_ASSERT_EQUAL_HEX8(0x77, read_ds1977(0x100, fresh));
	TEST_ASSERT_EQUAL_HEX8(0xFF, read_ds1977(0x100, wrong));
	TEST_ASSERT_EQUAL_HEX8(0xFF, read_ds1977(0x7FC0, fresh)); /* never read back */
}

static void test_a_ds1977_gives_its_version_twice(void)
{
	uint8_t in[3];

	plug(&sim_ds1977);
	hand_skip(&hand, 3, 0xCC, 0x00, 0x00);
	hand_read(&hand, in, 3);
	TEST_ASSERT_EQUAL_HEX8(in[0], in[1]);
	TEST_ASSERT_EQUAL_HEX8(0xFF, in[2]);
	TEST_ASSERT_NOT_EQUAL(0xFF, in[0]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_password_opens_a_subkey_and_a_wrong_one_reads_noise);
	RUN_TEST(test_a_subkey_is_written_with_its_password_only);
	RUN_TEST(test_an_address_without_its_complement_is_not_taken);
	RUN_TEST(test_a_new_password_clears_the_data);
	RUN_TEST(test_the_scratchpad_replaces_a_password_and_keeps_the_data);
	RUN_TEST(test_a_ds1425_is_a_ds1991_with_its_own_code);
	RUN_TEST(test_a_ds1977_reads_pages_with_a_checksum_that_leaves_out_the_password);
	RUN_TEST(test_a_ds1977_without_strong_pull_up_reads_ones);
	RUN_TEST(test_passwords_of_a_ds1977_guard_once_they_are_enabled);
	RUN_TEST(test_a_ds1977_gives_its_version_twice);
	return UNITY_END();
}
