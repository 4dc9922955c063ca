/* SPDX-License-Identifier: MIT */
/* Areas and fields over a link that serves areas itself: no command reaches a wire. */
#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/field.h"
#include "hal/wire/driver.h"
#include "unity.h"

static uint8_t chip[32];
static unsigned reads, writes;
static int fault;

static int area_read_of(struct link *link, const uint8_t rom[8], const struct area *area,
                        unsigned at, uint8_t *bytes, unsigned n)
{
	(void)link, (void)rom;
	TEST_ASSERT_EQUAL_STRING("registers", area->name);
	memcpy(bytes, chip + at, n);
	reads++;
	return fault;
}

static int area_write_of(struct link *link, const uint8_t rom[8], const struct area *area,
                         unsigned at, const uint8_t *bytes, unsigned n)
{
	(void)link, (void)rom;
	TEST_ASSERT_EQUAL_STRING("registers", area->name);
	memcpy(chip + at, bytes, n);
	writes++;
	return 0;
}

static int64_t now(void *ctx)
{
	(void)ctx;
	return 1000;
}

static bool has_driver(struct link *link, const uint8_t rom[8])
{
	(void)link, (void)rom;
	return true;
}

static const struct driver_ops driver = {
	.has = has_driver,
	.area_read = area_read_of,
	.area_write = area_write_of,
};
static const struct bus_env env = {.now = now};
static const struct link_ops ops;
static struct link link_of_areas = {.ops = &ops, .env = &env, .driver = &driver};
static unsigned char own[DEVICE_OWN];
static struct device device;
static struct txn txn;

static const struct area registers = {
	.name = "registers", .size = 32, .block = 32, .row = 8, .read = 0x69, .write = 0x6c};

enum { REGISTERS = 1 };
static const struct area *const areas[] = {[REGISTERS] = &registers};

enum { FLAGS, LIMITS, PAGE, WORD };
static const struct property properties[] = {
	[FLAGS] = PROPERTY("flags", BITS, VOLATILE, BOTH, AGGREGATE(3, NUMBERS),
                           FIELD(REGISTERS, .at = 1, .shift = 2, .inverted = true)),
	[LIMITS] = PROPERTY("limits", UNSIGNED, VOLATILE, BOTH, ELEMENTS(4, NUMBERS),
                            FIELD(REGISTERS, .at = 8, .stride = 2, .bytes = 2)),
	[PAGE] = PROPERTY("page", BINARY, VOLATILE, BOTH, ELEMENTS(4, NUMBERS), .size = 8,
                          FIELD(REGISTERS)),
	[WORD] = PROPERTY("word", FLOAT, VOLATILE, BOTH,
                          FIELD(REGISTERS, .at = 4, .bytes = 2, .shift = 5, .is_signed = true,
                                .big_endian = true, .unit = 0.5, .offset = 1)),
};
static const struct family family = {.code = 0x31, AREAS(areas), PROPERTIES(properties)};

void setUp(void)
{
	memset(chip, 0, sizeof(chip));
	device = (struct device){.rom = {0x31, 1}, .family = &family, .own = own};
	reads = writes = 0;
	fault = 0;
}

void tearDown(void)
{
}

static void begin(int property)
{
	txn = (struct txn){.link = &link_of_areas,
	                   .device = &device,
	                   .property = &properties[property],
	                   .since_ns = INT64_MAX,
	                   .oldest_ns = INT64_MAX};
}

static property_function *reader(int property)
{
	return property_reader(&family, &properties[property]);
}

static property_function *writer(int property)
{
	return property_writer(&family, &properties[property]);
}

static int end(property_function *function)
{
	int err = TXN_MORE;

	for (int i = 0; i < 50 && err == TXN_MORE; i++)
		err = function(&txn);
	return err;
}

static double value(int property, int element)
{
	begin(property);
	txn.element = element;
	TEST_ASSERT_EQUAL_INT(0, end(reader(property)));
	return txn.number[0];
}

static int set(int property, int element, double number)
{
	begin(property);
	txn.element = element;
	txn.number[0] = number;
	return end(writer(property));
}

static void test_a_field_is_its_bits_times_the_unit_and_the_offset(void)
{
	chip[4] = 0xff; /* -2, in the upper eleven bits */
	chip[5] = 0xdf;
	TEST_ASSERT_EQUAL_DOUBLE(0, value(WORD, 0));
	chip[4] = 0x7f;
	TEST_ASSERT_EQUAL_DOUBLE(1022 / 2.0 + 1, value(WORD, 0));
}

static void test_a_field_that_is_written_leaves_its_neighbours(void)
{
	memset(chip, 0x55, sizeof(chip));
	TEST_ASSERT_EQUAL_INT(0, set(WORD, 0, -3));
	TEST_ASSERT_EQUAL_DOUBLE(-3, value(WORD, 0));
	TEST_ASSERT_EQUAL_HEX8(0xff, chip[4]);
	TEST_ASSERT_EQUAL_HEX8(0x15, chip[5]);
	TEST_ASSERT_EQUAL_HEX8(0x55, chip[3]);
	TEST_ASSERT_EQUAL_HEX8(0x55, chip[6]);
}

static void test_a_value_that_has_no_bits_is_refused(void)
{
	TEST_ASSERT_EQUAL_INT(0, set(WORD, 0, 512.5));
	TEST_ASSERT_EQUAL_INT(-EINVAL, set(WORD, 0, 513));
	TEST_ASSERT_EQUAL_INT(0, set(WORD, 0, -511));
	TEST_ASSERT_EQUAL_INT(-EINVAL, set(WORD, 0, -512));
	TEST_ASSERT_EQUAL_INT(-EINVAL, set(LIMITS, 0, 65536));
	TEST_ASSERT_EQUAL_INT(-EINVAL, set(LIMITS, 0, -1));
}

static void test_one_bit_of_many_is_written_by_itself(void)
{
	chip[1] = 0xff;
	begin(FLAGS);
	txn.element = 1;
	txn.one = true;
	txn.bits = 2;
	TEST_ASSERT_EQUAL_INT(0, end(writer(FLAGS)));
	TEST_ASSERT_EQUAL_HEX8(0xf7, chip[1]);
	value(FLAGS, 0);
	TEST_ASSERT_EQUAL_HEX32(2, txn.bits);
}

static void test_elements_stand_a_stride_apart(void)
{
	TEST_ASSERT_EQUAL_INT(0, set(LIMITS, 3, 0x1234));
	TEST_ASSERT_EQUAL_HEX8(0x34, chip[14]);
	TEST_ASSERT_EQUAL_HEX8(0x12, chip[15]);
	TEST_ASSERT_EQUAL_DOUBLE(0x1234, value(LIMITS, 3));
	TEST_ASSERT_EQUAL_DOUBLE(0, value(LIMITS, 2));
}

static void test_what_is_there_already_is_not_written(void)
{
	TEST_ASSERT_EQUAL_INT(0, set(LIMITS, 1, 7));
	TEST_ASSERT_EQUAL_UINT(1, writes);
	TEST_ASSERT_EQUAL_INT(0, set(LIMITS, 1, 7));
	TEST_ASSERT_EQUAL_UINT(1, writes);
}

static void test_bytes_are_written_where_they_begin_in_their_element(void)
{
	static uint8_t text[] = "abc";

	begin(PAGE);
	txn.element = 2;
	txn.at = 3;
	txn.data = text;
	txn.len = 3;
	TEST_ASSERT_EQUAL_INT(0, end(writer(PAGE)));
	TEST_ASSERT_EQUAL_MEMORY("\0\0\0abc\0\0", chip + 16, 8);
}

static void test_an_error_of_the_link_is_that_of_the_property(void)
{
	fault = -ENOENT;
	begin(WORD);
	TEST_ASSERT_EQUAL_INT(-ENOENT, end(reader(WORD)));
	TEST_ASSERT_EQUAL_INT(-ENOENT, set(WORD, 0, 1));
	TEST_ASSERT_EQUAL_UINT(0, writes);
}

static void test_a_reading_serves_the_other_fields_that_may_be_as_old(void)
{
	chip[4] = 0x7f;
	value(WORD, 0);
	TEST_ASSERT_EQUAL_UINT(1, reads);
	begin(LIMITS);
	txn.since_ns = 1000;
	TEST_ASSERT_EQUAL_INT(0, reader(LIMITS)(&txn));
	TEST_ASSERT_EQUAL_UINT(1, reads);
	begin(LIMITS);
	txn.since_ns = 1001;
	TEST_ASSERT_EQUAL_INT(0, reader(LIMITS)(&txn));
	TEST_ASSERT_EQUAL_UINT(2, reads);
	/* Void: the device was away. */
	device_forget(&device);
	begin(LIMITS);
	txn.since_ns = 1000;
	TEST_ASSERT_EQUAL_INT(0, reader(LIMITS)(&txn));
	TEST_ASSERT_EQUAL_UINT(3, reads);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_field_is_its_bits_times_the_unit_and_the_offset);
	RUN_TEST(test_a_field_that_is_written_leaves_its_neighbours);
	RUN_TEST(test_a_value_that_has_no_bits_is_refused);
	RUN_TEST(test_one_bit_of_many_is_written_by_itself);
	RUN_TEST(test_elements_stand_a_stride_apart);
	RUN_TEST(test_what_is_there_already_is_not_written);
	RUN_TEST(test_bytes_are_written_where_they_begin_in_their_element);
	RUN_TEST(test_an_error_of_the_link_is_that_of_the_property);
	RUN_TEST(test_a_reading_serves_the_other_fields_that_may_be_as_old);
	return UNITY_END();
}
