/* SPDX-License-Identifier: MIT */
/* What is kept of a DS2438's configuration, over a link whose readings fail. */
#include <errno.h>
#include <string.h>

#include "hal/chips/batteries/ds2438.h"
#include "unity.h"

#define RECALL 0xb8

static uint8_t begun; /* the first command since setUp() */
static int fault;

/* Bytes whose checksum is wrong, or an error. */
static int run(struct link *link, const struct link_part *part)
{
	(void)link;
	if (!begun && part->out_n > 9)
		begun = part->out[9];
	if (!part->in_n)
		return 0;
	memset(part->in, 0x5a, part->in_n);
	return fault;
}

static const struct link_ops ops = {.run = run};
static const struct link_facts facts = {.strong = true, .splits = true};
static struct ds2438 known;
static struct device device;
static struct link wire;
static struct txn txn;

void setUp(void)
{
	wire = (struct link){.ops = &ops, .facts = &facts};
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
