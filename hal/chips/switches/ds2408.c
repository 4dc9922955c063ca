/* SPDX-License-Identifier: MIT */
/*
 * The registers of a DS2408 (data sheet 19-5702), and its eight outputs.
 *
 * Reset Activity Latches and Channel Access Write are confirmed (AAh); outputs and the settings of
 * the conditional search are read back. A disturbed command can clear the power-on flag: the bus
 * reports that as a restart.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/switches/ds2408.h"

#define WRITE_OUTPUT 0x5a
#define WRITE_CONDITION 0xcc
#define RESET_LATCHES 0xc3

#define CONTROL_STROBE (1 << DS2408_STROBE)
#define CONTROL_POR (1 << DS2408_POR)
#define CONTROL_VCC (1 << DS2408_VCC)

void ds2408_saw_control(struct txn *txn, uint8_t value)
{
	struct ds2408 *chip = txn->device->own;
	bool por = value & CONTROL_POR;

	txn->restarted |= por && chip->por_clear;
	chip->por_clear = !por;
	txn->device->power = value & CONTROL_VCC ? POWER_EXTERNAL : POWER_PARASITE;
}

static int read_control(struct txn *txn)
{
	uint8_t value;
	int err = area_fetch(txn, &ds2408_registers, DS2408_CONTROL, &value, 1);

	if (!err)
		ds2408_saw_control(txn, value);
	return err;
}

/*
 * A driver's come in part, and without a checksum: all ones is also what one hears of a chip that
 * is not there, which the control register shows.
 */
static int saw_registers(struct txn *txn, unsigned at, uint8_t *value, unsigned n)
{
	if (at <= DS2408_CONTROL && at + n > DS2408_CONTROL)
		ds2408_saw_control(txn, value[DS2408_CONTROL - at]);
	else if (value[0] == 0xff)
		return read_control(txn);
	return 0;
}

AREA_NAMED(ds2408_registers, "registers", .at = 0x88, .size = DS2408_REGISTERS,
           .block = DS2408_REGISTERS, .parts = true, .address_bytes = 2, .read = 0xf0,
           .check = AREA_CRC16, .saw = saw_registers);

/* A part of the registers that is written by itself. */
static int load_part(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                     unsigned n)
{
	uint8_t value[DS2408_REGISTERS];
	int err = area_fetch(txn, &ds2408_registers, 0, value, DS2408_REGISTERS);

	if (err)
		return err;
	memcpy(bytes, value + (area->at - ds2408_registers.at) + at, n);
	return saw_registers(txn, 0, value, DS2408_REGISTERS);
}

int ds2408_leave_test_mode(struct txn *txn)
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
		if (answer[0] == DS2408_CONFIRMED)
			continue;
		bool silent = txn->silent;
		err = ds2408_leave_test_mode(txn);
		txn->silent = silent;
		return err ? err : silent ? -EBADMSG : -EIO;
	}
	return 0;
}

static int store_output(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
                        unsigned n)
{
	(void)area, (void)at;
	return ds2408_put(txn, bytes, n);
}

static int saw_latch(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)at, (void)n;
	return bytes[0] == 0xff && txn_driven(txn) ? read_control(txn) : 0;
}

AREA_NAMED(ds2408_output, "output", .at = 0x88 + DS2408_OUTPUT, .size = 1, .row = 1, .hidden = true,
           .load = load_part, .store = store_output, .saw = saw_latch);

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
	(void)at, (void)n;
	ds2408_saw_control(txn, bytes[2]);
	bytes[2] &= DS2408_SETTINGS | CONTROL_POR;
	return 0;
}

/* A power-on flag that a disturbed write has cleared can only be reported, not set. */
bool ds2408_condition_is_written(struct txn *txn, const uint8_t *have, const uint8_t *want,
                                 unsigned n)
{
	(void)n;
	if (memcmp(have, want, 2) != 0 || ((have[2] ^ want[2]) & DS2408_SETTINGS) ||
	    (have[2] & ~want[2] & CONTROL_POR))
		return false;
	txn->restarted |= (want[2] & ~have[2] & CONTROL_POR) != 0;
	return true;
}

/* Mask, polarity and control. */
AREA_NAMED(ds2408_condition, "condition", .at = 0x88 + DS2408_MASK, .size = 3, .row = 3,
           .load = load_part, .store = store_condition, .saw = saw_condition,
           .is_written = ds2408_condition_is_written);

int ds2408_strobe(struct txn *txn)
{
	static const uint8_t strobe = CONTROL_STROBE;

	return area_write(txn, &ds2408_condition, DS2408_CONTROL - DS2408_MASK, &strobe, &strobe,
	                  1);
}

int ds2408_write_latch(struct txn *txn)
{
	static AREA_NAMED(latches, "latches", .size = 1);
	uint8_t answer;

	if (txn_driven(txn))
		return txn_driver_write(txn, &latches, 0, TXN_BYTES(RESET_LATCHES));
	int err = txn_ask(txn, TXN_BYTES(RESET_LATCHES), &answer, 1);
	return err ? err : answer == DS2408_CONFIRMED ? 0 : -EBADMSG;
}

double ds2408_digits(const uint8_t condition[3], unsigned n)
{
	uint32_t digits = condition[2] & DS2408_CONTROL_SOURCE;

	while (n--)
		digits = 10 * digits + (condition[0] >> n & 1) * 2u + (condition[1] >> n & 1);
	return digits;
}

void ds2408_condition_of(double number, unsigned n, uint8_t condition[3])
{
	uint32_t digits = (uint32_t)number;

	memset(condition, 0, 3);
	for (unsigned i = 0; i < n; i++, digits /= 10) {
		condition[0] |= (uint8_t)((digits % 10 >> 1 & 1) << i);
		condition[1] |= (uint8_t)((digits % 10 & 1) << i);
	}
	condition[2] = (uint8_t)(digits & DS2408_CONTROL_SOURCE);
}
