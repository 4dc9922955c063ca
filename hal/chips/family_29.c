/* SPDX-License-Identifier: MIT */
/* DS2408 (data sheet 19-5702): eight switches with activity latches. */
#include <errno.h>

#include "hal/chips/ds2408.h"
#include "hal/chips/family.h"
#include "hal/chips/lcd.h"

#define RESET_LATCHES 0xc3
#define CONFIRMED 0xaa

static int write_latch(struct txn *txn)
{
	static const struct area latches = {.name = "latches", .size = 1};
	static const uint8_t command = RESET_LATCHES;
	uint8_t answer;

	if (txn_driven(txn))
		return txn_driver_write(txn, &latches, 0, &command, 1);
	int err = txn_command(txn, &command, 1);

	if (!err)
		err = txn_read(txn, &answer, 1);
	return err ? err : answer == CONFIRMED ? 0 : -EBADMSG;
}

/* A digit for each channel, 2 selected + 1 high; before them the source. */
static int read_alarm(struct txn *txn)
{
	uint8_t value[3];
	int err = area_read(txn, &ds2408_registers, DS2408_MASK, value, sizeof(value));
	uint32_t digits = value[2] & DS2408_CONTROL_SOURCE;

	for (int i = 7; i >= 0 && !err; i--)
		digits = 10 * digits + (value[0] >> i & 1) * 2u + (value[1] >> i & 1);
	txn->number[0] = digits;
	return err;
}

static int write_alarm(struct txn *txn)
{
	static const uint8_t which[] = {0xff, 0xff, DS2408_CONTROL_SOURCE};
	uint32_t digits = (uint32_t)txn->number[0];
	uint8_t value[3] = {0};

	for (int i = 0; i < 8; i++, digits /= 10) {
		value[0] |= (uint8_t)((digits % 10 >> 1 & 1) << i);
		value[1] |= (uint8_t)((digits % 10 & 1) << i);
	}
	value[2] = (uint8_t)(digits & DS2408_CONTROL_SOURCE);
	return area_write(txn, &ds2408_condition, 0, value, which, sizeof(value));
}

static int write_test_mode(struct txn *txn)
{
	return txn->number[0] == 0 ? 0 : ds2408_leave_test_mode(txn);
}

#define FLAG(text, life_, access_, bit, ...) \
	PROPERTY(text, YESNO, life_, access_, \
	         FIELD(ds2408_registers, .at = DS2408_CONTROL, .shift = (bit), .bits = 1), \
	         SET(ds2408_condition, .at = DS2408_CONTROL - DS2408_MASK, .shift = (bit), \
	             .bits = 1), \
	         __VA_ARGS__)

static const struct property properties[] = {
	LCD_PROPERTIES,
	PROPERTY("PIO", BITS, STABLE, BOTH, AGGREGATE(8, NUMBERS),
                 FIELD(ds2408_registers, .at = DS2408_OUTPUT, .inverted = true),
                 SET(ds2408_output, .inverted = true)),
	PROPERTY("latch", BITS, VOLATILE, BOTH, AGGREGATE(8, NUMBERS),
                 FIELD(ds2408_registers, .at = DS2408_ACTIVITY), .flag = true,
                 .write = write_latch),
	PROPERTY("out_of_testmode", YESNO, VOLATILE, WRITE, .write = write_test_mode),
	FLAG("por", STABLE, BOTH, DS2408_POR, .flag = true),
	FLAG("power", VOLATILE, READ, DS2408_VCC, .flag = false),
	PROPERTY("sensed", BITS, VOLATILE, READ, AGGREGATE(8, NUMBERS), FIELD(ds2408_registers)),
	PROPERTY("set_alarm", UNSIGNED, STABLE, BOTH, .digits = "333333333", .read = read_alarm,
                 .write = write_alarm),
	FLAG("strobe", STABLE, BOTH, DS2408_STROBE, .flag = false),
};

const struct family family_29 = {
	.code = 0x29,
	.alarms = true,
	.type = "DS2408",
	PROPERTIES(properties),
};
