/* SPDX-License-Identifier: MIT */
/* What is kept of a DS2438's configuration, over a link whose readings fail. */
#include <errno.h>
#include <string.h>

#include "hal/chips/batteries/ds2438.h"
#include "unity.h"

#define RECALL 0xb8

static uint8_t begun; /* the first command since setUp() */
static int fault;

static int reset(struct link *link)
{
	(void)link;
	return 1;
}

static int write_of(struct link *link, const uint8_t *data, size_t n, enum link_after after)
{
	(void)link, (void)after;
	if (!begun && n > 9)
		begun = data[9];
	return 0;
}

/* Bytes whose checksum is wrong, or an error. */
static int read_of(struct link *link, uint8_t *data, size_t n)
{
	(void)link;
	memset(data, 0x5a, n);
	return fault;
}

static const struct link_ops ops = {.reset = reset, .write = write_of, .read = read_of};
static struct ds2438 known;
static struct device device;
static struct link wire;
static struct txn txn;

void setUp(void)
{
	wire = (struct link){.ops = &ops};
	device = (struct device){.rom = {0x26, 1}, .own = &known};
	known = (struct ds2438){0};
	fault = 0;
}

void tearDown(void)
{
}

static void begin(void)
{
	txn = (struct txn){.link = &wire, .device = &device};
	begun = 0;
}

static void a_failed_reading_is_not_selected_by(int error)
{
	uint8_t bytes[8];

	fault = error;
	begin();
	TEST_ASSERT_EQUAL_INT(error ? error : -EBADMSG, ds2438_read(&txn, 0, bytes));
	begin();
	ds2438_select(&txn, DS2438_AD);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(RECALL, begun, "the configuration is read first");
}

static void test_the_configuration_of_a_failed_reading_is_not_known(void)
{
	a_failed_reading_is_not_selected_by(0);
	a_failed_reading_is_not_selected_by(-EIO);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_configuration_of_a_failed_reading_is_not_known);
	return UNITY_END();
}
