/* SPDX-License-Identifier: MIT */
/* DS2408 (data sheet 19-5702): eight switches with activity latches. */
#include <errno.h>

#include "hal/chips/family.h"
#include "hal/chips/switches/ds2408.h"
#include "hal/chips/switches/lcd.h"

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
	         FIELD(REGISTERS, .at = DS2408_CONTROL, .shift = (bit), .bits = 1), __VA_ARGS__)

enum { REGISTERS = 1, OUTPUT, CONDITION };
static const struct area *const areas[] = {
	[REGISTERS] = &ds2408_registers,
	[OUTPUT] = &ds2408_output,
	[CONDITION] = &ds2408_condition,
};

#define SET_CONTROL(bit) \
	SET(CONDITION, .at = DS2408_CONTROL - DS2408_MASK, .shift = (bit), .bits = 1)
enum { WAY_PIO = AFTER_LCD_WAYS, WAY_LATCH, WAY_TEST_MODE, WAY_POR, WAY_STROBE, WAY_ALARM };
static const struct property_how how[] = {
	LCD_WAYS,
	[WAY_PIO] = {SET(OUTPUT, .inverted = true)},
	[WAY_LATCH] = {.write = write_latch},
	[WAY_TEST_MODE] = {.write = write_test_mode},
	[WAY_POR] = {SET_CONTROL(DS2408_POR)},
	[WAY_STROBE] = {SET_CONTROL(DS2408_STROBE)},
	[WAY_ALARM] = {.read = read_alarm, .write = write_alarm},
};

static const struct property properties[] = {
	LCD_PROPERTIES,
	PROPERTY("PIO", BITS, STABLE, BOTH, AGGREGATE(8, NUMBERS),
                 FIELD(REGISTERS, .at = DS2408_OUTPUT, .inverted = true), .holds = true,
                 .how = WAY_PIO),
	PROPERTY("latch", BITS, VOLATILE, BOTH, AGGREGATE(8, NUMBERS),
                 FIELD(REGISTERS, .at = DS2408_ACTIVITY), .flag = true, .how = WAY_LATCH),
	PROPERTY("out_of_testmode", YESNO, VOLATILE, WRITE, .how = WAY_TEST_MODE),
	FLAG("por", STABLE, BOTH, DS2408_POR, .flag = true, .how = WAY_POR),
	FLAG("power", VOLATILE, READ, DS2408_VCC, .flag = false),
	PROPERTY("sensed", BITS, VOLATILE, READ, AGGREGATE(8, NUMBERS), FIELD(REGISTERS)),
	PROPERTY("set_alarm", UNSIGNED, STABLE, BOTH, .digits = 333333333, .how = WAY_ALARM),
	FLAG("strobe", STABLE, BOTH, DS2408_STROBE, .how = WAY_STROBE),
};

const struct family family_29 = {
	.code = 0x29,
	.proof = PROOF_PRESENCE,
	.alarms = true,
	.type = "DS2408",
	.flags = FLAG_RESUME | FLAG_ALARM | FLAG_OVERDRIVE,
	SCAN({"sensed.BYTE", "inputs"}, {"PIO.BYTE", "outputs"}),
	AREAS(areas),
	HOW(how),
	PROPERTIES(properties),
};
