/* SPDX-License-Identifier: MIT */
/* Writes at an offset: parts of all values that are bytes, and no part of any other. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/find.h"
#include "unity.h"

#include "hal/chips/family.h"
#include "hal/chips/format.h"
#include "tests/unit/aid/one_slave.h"

#define VALUE_MAX 600

/* DS2408's and the families without a simulated chip are in files of their own. */
static const char *const chips[] = {"DS2401",  "DS2405", "DS2406", "DS2408",  "DS2413", "DS2423",
                                    "DS2430A", "DS2431", "DS2433", "DS2438",  "DS2450", "DS18B20",
                                    "DS18S20", "DS1822", "DS1992", "DS1963S", "DS2404"};
#define CHIPS (sizeof(chips) / sizeof(chips[0]))

void setUp(void)
{
	one_slave_begin();
}

void tearDown(void)
{
	one_slave_end();
}

static void start(const char *chip)
{
	wire_init(&host, 1, 1);
	slave = wire_add(0, chip, 1);
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
}

static void get(const char *name, uint8_t *bytes, unsigned size)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, go(BUS_READ, name, NULL)->err, name);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(size, host.answer[0].len, name);
	memcpy(bytes, slave_data, size);
}

/* Nothing but the part changes, and what is behind the end is not taken. */
static void put_part(const char *name, uint8_t *bytes, unsigned size, unsigned at, unsigned n,
                     char letter)
{
	unsigned fit = at >= size ? 0 : size - at < n ? size - at : n;
	uint8_t now[VALUE_MAX];
	char text[VALUE_MAX];

	memset(text, letter, n);
	text[n] = '\0';
	if (fit)
		memcpy(bytes + at, text, fit);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, put_at(at, name, text)->err, name);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(fit, host.answer[0].len, name);
	get(name, now, size);
	TEST_ASSERT_EQUAL_MEMORY_MESSAGE(bytes, now, size, name);
}

static void try_parts(const char *name, unsigned size)
{
	static const unsigned at[] = {1, 3, 7, 8, 9, 31, 32, 33, 63, 100, 511},
			      length[] = {1, 2, 9, 40, 70};
	uint8_t bytes[VALUE_MAX];
	char letter = 'a';

	get(name, bytes, size);
	for (unsigned i = 0; i < sizeof(at) / sizeof(at[0]); i++)
		for (unsigned k = 0; k < sizeof(length) / sizeof(length[0]) && at[i] < size; k++)
			put_part(name, bytes, size, at[i], length[k], letter++);
	put_part(name, bytes, size, size - 1, 2, letter++);
	put_part(name, bytes, size, size, 2, letter++);
	put_part(name, bytes, size, 100000, 2, letter++);
	put_part(name, bytes, size, UINT32_MAX, 2, letter);
}

/* An EPROM is only read, an application register written once; registers change by themselves. */
static bool keeps(const char *chip, const char *name, int element)
{
	if (strcmp(chip, "DS2406") == 0)
		return false;
	if (strcmp(name, "application") == 0)
		return false;
	if (strcmp(chip, "DS2438") == 0)
		return element >= 3 && element <= 6;
	if (strcmp(chip, "DS2450") == 0)
		return strcmp(name, "pages/page") == 0 && element == 2;
	return true;
}

static unsigned try_property(const char *chip, const struct property *property)
{
	bool letters = property->array.index == INDEX_LETTERS;
	int elements = property->array.index == INDEX_NONE ? 1 : property->array.count;
	unsigned tried = 0;
	char name[80], extension[8];

	for (int element = 0; element < elements; element++) {
		extension_print(property, letters ? 256 + element : element, extension);
		snprintf(name, sizeof(name), "%s%s", property->name, extension);
		if (property->type != PROPERTY_BINARY || property->access != ACCESS_BOTH) {
			refuses(0, BUS_PROBE, name, NULL);
			TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, put_at(1, name, "1")->err, name);
		} else if (keeps(chip, property->name, element)) {
			try_parts(name, property_size(property));
			tried++;
		}
	}
	if (elements > 1) {
		snprintf(name, sizeof(name), "%s.ALL", property->name);
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, put_at(1, name, "1")->err, name);
	}
	return tried;
}

static void test_bytes_take_a_part_and_other_values_take_none(void)
{
	unsigned tried = 0;

	for (unsigned i = 0; i < CHIPS; i++) {
		const struct property *property = NULL;
		const struct family *family;

		if (i)
			setUp();
		start(chips[i]);
		family = family_of(slave->rom[0]);
		while ((property = family_next(family, NULL, property)))
			if (property->access & ACCESS_WRITE && !property->kinds)
				tried += try_property(chips[i], property);
		tearDown();
	}
	/* memories of 2423, 2430A, 2431 and 2433, then pages of 2423, 2431, 2433, 2438 and 2450 */
	unsigned before = 4 + 16 + 4 + 16 + 4 + 1;
	/* memories and pages of 1992, 1963S and 2404 */
	TEST_ASSERT_EQUAL_UINT(before + 3 + 4 + 16 + 16, tried);
	setUp();
}

/* Its third page holds limits, which keep what is written. */
static void test_a_part_of_a_ds2450s_memory_is_written_over_two_pages(void)
{
	uint8_t before[32], now[32];

	start("DS2450");
	get("memory", before, 32);
	TEST_ASSERT_EQUAL_INT(0, put_at(18, "memory", "abc")->err);
	TEST_ASSERT_EQUAL_UINT(3, host.answer[0].len);
	memcpy(before + 18, "abc", 3);
	get("memory", now, 32);
	TEST_ASSERT_EQUAL_MEMORY(before, now, 32);
	TEST_ASSERT_EQUAL_INT(0, put_at(22, "memory", "defg")->err);
	memcpy(before + 22, "defg", 4);
	get("memory", now, 32);
	TEST_ASSERT_EQUAL_MEMORY(before, now, 32);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_bytes_take_a_part_and_other_values_take_none);
	RUN_TEST(test_a_part_of_a_ds2450s_memory_is_written_over_two_pages);
	return UNITY_END();
}
