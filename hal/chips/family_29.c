/* SPDX-License-Identifier: MIT */
/* DS2408 (data sheet 19-5702): eight switches with activity latches. */
#include <errno.h>
#include <string.h>

#include "hal/chips/ds2408.h"
#include "hal/chips/lcd.h"

#define WRITE_OUTPUT 0x5a
#define WRITE_CONDITION 0xcc
#define RESET_LATCHES 0xc3
#define CONFIRMED 0xaa

/* The registers from 0x88 on. */
enum { PIN, OUTPUT, ACTIVITY, MASK, POLARITY, CONTROL, REGISTERS = 8 };

/* Bits of the control register. */
enum { SOURCE, STROBE = 2 /* ROS */, POR, VCC = 7 };
#define CONTROL_SOURCE 0x03
#define CONTROL_SETTINGS 0x07
#define CONTROL_STROBE (1 << STROBE)
#define CONTROL_POR (1 << POR)
#define CONTROL_VCC (1 << VCC)

static int saw_registers(struct txn *txn, unsigned at, uint8_t *value, unsigned n)
{
	struct device *device = txn->device;
	struct ds2408 *chip = device->own;
	bool por = value[CONTROL] & CONTROL_POR;

	(void)at, (void)n;
	if ((por && chip->por_clear) || (device->shadow_known && device->shadow != value[OUTPUT]))
		txn->restarted = true;
	chip->por_clear = !por;
	device->shadow = value[OUTPUT];
	device->shadow_known = true;
	device->power = value[CONTROL] & CONTROL_VCC ? POWER_EXTERNAL : POWER_PARASITE;
	return 0;
}

static const struct area registers = {
	.name = "registers",
	.at = 0x88,
	.size = REGISTERS,
	.block = REGISTERS,
	.address_bytes = 2,
	.read = 0xf0,
	.check = AREA_CRC16,
	.saw = saw_registers,
};

/* A part of the registers that is written by itself. */
static int load_part(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                     unsigned n)
{
	uint8_t value[REGISTERS];
	int err = area_fetch(txn, &registers, 0, value, REGISTERS);

	if (err)
		return err;
	memcpy(bytes, value + (area->at - registers.at) + at, n);
	return saw_registers(txn, 0, value, REGISTERS);
}

/* The way out of the test mode in which a slow supply can leave the chip (data sheet, page 39). */
static int leave_test_mode(struct txn *txn)
{
	uint8_t bytes[10] = {0x96};

	memcpy(bytes + 1, txn->device->rom, 8);
	bytes[9] = 0x3c;
	return txn_raw(txn, bytes, sizeof(bytes));
}

/*
 * Each byte is confirmed, and then its effect on the pins told, before the next. Where a link does
 * not take a write behind a read, each has a transaction of its own.
 */
int ds2408_put(struct txn *txn, const uint8_t *bytes, unsigned n)
{
	uint8_t command[] = {WRITE_OUTPUT, 0, 0}, answer[2];
	int err = 0;

	txn->device->shadow_known = false;
	for (unsigned i = 0; i < n; i++) {
		command[1] = bytes[i];
		command[2] = (uint8_t)~bytes[i];
		err = i ? txn_write(txn, command + 1, 2) : -EOPNOTSUPP;
		if (err == -EOPNOTSUPP)
			err = txn_command(txn, command, sizeof(command));
		if (!err)
			err = txn_read(txn, answer, sizeof(answer));
		if (err)
			return err;
		if (answer[0] == CONFIRMED)
			continue;
		bool silent = txn->silent;
		err = leave_test_mode(txn);
		txn->silent = silent;
		return err ? err : silent ? -EBADMSG : -EIO;
	}
	return 0;
}

static int write_latch(struct txn *txn)
{
	static const uint8_t command = RESET_LATCHES;
	uint8_t answer;
	int err = txn_command(txn, &command, 1);

	if (!err)
		err = txn_read(txn, &answer, 1);
	return err ? err : answer == CONFIRMED ? 0 : -EBADMSG;
}

static int store_output(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
                        unsigned n)
{
	(void)area, (void)at;
	return ds2408_put(txn, bytes, n);
}

static const struct area output = {
	.name = "output",
	.at = 0x88 + OUTPUT,
	.size = 1,
	.row = 1,
	.load = load_part,
	.store = store_output,
};

static int store_condition(struct txn *txn, const struct area *area, unsigned at,
                           const uint8_t *bytes, unsigned n)
{
	uint8_t command[] = {WRITE_CONDITION, (uint8_t)area->at, 0x00,
	                     bytes[0],        bytes[1],          bytes[2]};
	struct ds2408 *chip = txn->device->own;

	(void)at, (void)n;
	if (!(bytes[2] & CONTROL_POR))
		chip->por_clear = false;
	return txn_command(txn, command, sizeof(command));
}

static int saw_condition(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)txn, (void)at, (void)n;
	bytes[2] &= CONTROL_SETTINGS | CONTROL_POR;
	return 0;
}

/* A power-on flag that a disturbed write has cleared can only be told, not set. */
static bool condition_is_written(struct txn *txn, const uint8_t *have, const uint8_t *want,
                                 unsigned n)
{
	(void)n;
	if (memcmp(have, want, 2) != 0 || ((have[2] ^ want[2]) & CONTROL_SETTINGS) ||
	    (have[2] & ~want[2] & CONTROL_POR))
		return false;
	txn->restarted |= (want[2] & ~have[2] & CONTROL_POR) != 0;
	return true;
}

/* Mask, polarity and control. */
static const struct area condition = {
	.name = "condition",
	.at = 0x88 + MASK,
	.size = 3,
	.row = 3,
	.load = load_part,
	.store = store_condition,
	.saw = saw_condition,
	.is_written = condition_is_written,
};

/* A digit for each channel, 2 selected + 1 high; before them the source. */
static int read_alarm(struct txn *txn)
{
	uint8_t value[3];
	int err = area_read(txn, &registers, MASK, value, sizeof(value));
	uint32_t digits = value[2] & CONTROL_SOURCE;

	for (int i = 7; i >= 0 && !err; i--)
		digits = 10 * digits + (value[0] >> i & 1) * 2u + (value[1] >> i & 1);
	txn->number[0] = digits;
	return err;
}

static int write_alarm(struct txn *txn)
{
	static const uint8_t which[] = {0xff, 0xff, CONTROL_SOURCE};
	uint32_t digits = (uint32_t)txn->number[0];
	uint8_t value[3] = {0};

	for (int i = 0; i < 8; i++, digits /= 10) {
		value[0] |= (uint8_t)((digits % 10 >> 1 & 1) << i);
		value[1] |= (uint8_t)((digits % 10 & 1) << i);
	}
	value[2] = (uint8_t)(digits & CONTROL_SOURCE);
	return area_write(txn, &condition, 0, value, which, sizeof(value));
}

int ds2408_strobe(struct txn *txn)
{
	static const uint8_t strobe = CONTROL_STROBE;

	return area_write(txn, &condition, CONTROL - MASK, &strobe, &strobe, 1);
}

static int write_test_mode(struct txn *txn)
{
	return txn->number[0] == 0 ? 0 : leave_test_mode(txn);
}

#define FLAG(text, life_, access_, bit, ...) \
	PROPERTY(text, YESNO, life_, access_, \
	         FIELD(registers, .at = CONTROL, .shift = (bit), .bits = 1), \
	         SET(condition, .at = CONTROL - MASK, .shift = (bit), .bits = 1), __VA_ARGS__)

static const struct property properties[] = {
	LCD_PROPERTIES,
	PROPERTY("PIO", BITS, STABLE, BOTH, AGGREGATE(8, NUMBERS),
                 FIELD(registers, .at = OUTPUT, .inverted = true), SET(output, .inverted = true)),
	PROPERTY("latch", BITS, VOLATILE, BOTH, AGGREGATE(8, NUMBERS),
                 FIELD(registers, .at = ACTIVITY), .flag = true, .write = write_latch),
	PROPERTY("out_of_testmode", YESNO, VOLATILE, WRITE, .write = write_test_mode),
	FLAG("por", STABLE, BOTH, POR, .flag = true),
	FLAG("power", VOLATILE, READ, VCC, .flag = false),
	PROPERTY("sensed", BITS, VOLATILE, READ, AGGREGATE(8, NUMBERS), FIELD(registers)),
	PROPERTY("set_alarm", UNSIGNED, STABLE, BOTH, .digits = "333333333", .read = read_alarm,
                 .write = write_alarm),
	FLAG("strobe", STABLE, BOTH, STROBE, .flag = false),
};

const struct family family_29 = {
	.code = 0x29,
	.alarms = true,
	.type = "DS2408",
	PROPERTIES(properties),
};
