/* SPDX-License-Identifier: MIT */
/* DS2408 (data sheet 19-5702): eight switches with activity latches. */
#include <errno.h>

#include "hal/chips/family.h"
#include "hal/chips/switches/ds2408.h"
#include "hal/chips/switches/lcd.h"

#define PINS 8

static int read_alarm(struct txn *txn)
{
	uint8_t condition[3] = {0};
	int err = area_read(txn, &ds2408_registers, DS2408_MASK, condition, sizeof(condition));

	txn->number[0] = ds2408_digits(condition, PINS);
	return err;
}

static int write_alarm(struct txn *txn)
{
	static const uint8_t which[] = {0xff, 0xff, DS2408_CONTROL_SOURCE};
	uint8_t condition[3];

	ds2408_condition_of(txn->number[0], PINS, condition);
	return area_write(txn, &ds2408_condition, 0, condition, which, sizeof(condition));
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
	[WAY_LATCH] = {.write = ds2408_write_latch},
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
                 FIELD(REGISTERS, .at = DS2408_ACTIVITY), .flag = true,
                 .alarm = ALARM_LATCH | ALARM_STAYS | ALARM_CLEARS, .how = WAY_LATCH),
	PROPERTY("out_of_testmode", YESNO, VOLATILE, WRITE, .how = WAY_TEST_MODE),
	FLAG("por", STABLE, BOTH, DS2408_POR, .flag = true, .alarm = ALARM_POR, .how = WAY_POR),
	FLAG("power", VOLATILE, READ, DS2408_VCC, .flag = false),
	PROPERTY("sensed", BITS, VOLATILE, READ, AGGREGATE(8, NUMBERS), FIELD(REGISTERS),
                 .alarm = ALARM_LATCH),
	PROPERTY("set_alarm", UNSIGNED, STABLE, BOTH, .digits = 333333333, .how = WAY_ALARM),
	FLAG("strobe", STABLE, BOTH, DS2408_STROBE, .how = WAY_STROBE),
};

CHIP_FAMILY(29, "DS2408", PRESENCE, .alarms = true,
            .flags = FLAG_RESUME | FLAG_ALARM | FLAG_OVERDRIVE,
            SCAN({"sensed.BYTE", "inputs"}, {"PIO.BYTE", "outputs"}), AREAS(areas), HOW(how),
            PROPERTIES(properties));
