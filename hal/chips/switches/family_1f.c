/* SPDX-License-Identifier: MIT */
/*
 * DS2409 (data sheet 102199, "MicroLAN Coupler"): its status and its control output. What is behind
 * its branches the bus reaches by itself (hal/wire/coupler.h), and for that it clears the event
 * flags: it keeps what it saw of them.
 *
 * Smart-On and All Lines Off are confirmed, and behind Smart-On only the chips of that branch
 * listen. The status comes twice, and is read three times; what is written is read back.
 */
#include <errno.h>

#include "hal/chips/family.h"
#include "hal/wire/coupler.h"

#define STATUS 0x5a
#define ALL_LINES_OFF 0x66
#define DISCHARGE_LINES 0x99
#define DISCHARGE_NS (100 * TXN_MS)

/* Behind the command stands a byte that is not to be written, in the place of an address. */
static AREA_NAMED(status, "status", .at = 0x18, .size = 1, .address_bytes = 1, .read = STATUS);

/* Bits n and n + 2 of the status are those of the two branches. */
static uint32_t pair(uint8_t byte, unsigned shift)
{
	return (byte >> shift & 1) | (byte >> (shift + 1) & 2);
}

static int read_branch(struct txn *txn)
{
	uint8_t byte = 0;
	int err = area_read(txn, &status, 0, &byte, 1);

	txn->bits = pair((uint8_t)~byte, 0);
	return err;
}

static int read_sensed(struct txn *txn)
{
	uint8_t byte = 0;
	int err = area_read(txn, &status, 0, &byte, 1);

	txn->bits = pair(byte, 1);
	return err;
}

static int read_event(struct txn *txn)
{
	struct coupler_seen *seen = txn->device->own;
	uint8_t byte = 0;
	int err = area_read(txn, &status, 0, &byte, 1);

	if (!err)
		seen->events |= byte >> 4 & 3;
	txn->bits = seen->events;
	return err;
}

/* The chip confirms a command by its code. */
static int family_1f_command(struct txn *txn, uint8_t code)
{
	uint8_t answer;
	int err = txn_ask(txn, &code, 1, &answer, 1);

	return err ? err : answer == code ? 0 : -EBADMSG;
}

static int switch_all_off(struct txn *txn)
{
	struct coupler_seen *seen = txn->device->own;
	int err = family_1f_command(txn, ALL_LINES_OFF);

	if (!err)
		seen->events = seen->flags = 0;
	return err;
}

/* The bus itself switches the branches on, whenever it needs one. */
static int write_branch(struct txn *txn)
{
	return txn->bits ? -EOPNOTSUPP : switch_all_off(txn);
}

static int write_clearevent(struct txn *txn)
{
	return txn->number[0] != 0 ? switch_all_off(txn) : 0;
}

/* The wire is left alone meanwhile: any other command to the chip ends the discharge. */
static int write_discharge(struct txn *txn)
{
	if (txn->number[0] == 0)
		return 0;
	if (txn->phase)
		return switch_all_off(txn);
	int err = family_1f_command(txn, DISCHARGE_LINES);
	if (err)
		return err;
	txn->phase = 1;
	txn->strong = true;
	return txn_wait(txn, DISCHARGE_NS);
}

/* 0 does not conduct, 1 conducts, 2 with the main branch, 3 with the auxiliary one. */
static const struct {
	uint8_t write, info;
} controls[] = {{0x20, 0x80}, {0xa0, 0xc0}, {0x00, 0x00}, {0x40, 0x40}};
#define CONTROLS 4

static int read_control(struct txn *txn)
{
	uint8_t byte = 0;
	int err = area_read(txn, &status, 0, &byte, 1);

	for (unsigned i = 0; i < CONTROLS; i++)
		if (controls[i].info == (byte & 0xc0))
			txn->number[0] = i;
	return err;
}

/* Written, and then looked at. */
static int write_control(struct txn *txn)
{
	double want = txn->number[0];

	if (want >= CONTROLS)
		return -EINVAL;
	if (txn->phase == 0) {
		const uint8_t write[] = {STATUS, controls[(unsigned)want].write};
		uint8_t answer[2];
		int err = txn_ask(txn, write, sizeof(write), answer, sizeof(answer));

		if (err)
			return err;
		if (answer[0] != answer[1])
			return -EBADMSG;
		txn->phase = 1;
		return TXN_MORE;
	}
	int err = read_control(txn);
	bool is_there = txn->number[0] == want;

	txn->number[0] = want;
	return err ? err : is_there ? 0 : -EIO;
}

enum { WAY_BRANCH = 1, WAY_CLEAR, WAY_CONTROL, WAY_DISCHARGE, WAY_EVENT, WAY_SENSED };
static const struct property_how how[] = {
	[WAY_BRANCH] = {.read = read_branch, .write = write_branch},
	[WAY_CLEAR] = {.write = write_clearevent},
	[WAY_CONTROL] = {.read = read_control, .write = write_control},
	[WAY_DISCHARGE] = {.write = write_discharge},
	[WAY_EVENT] = {.read = read_event},
	[WAY_SENSED] = {.read = read_sensed},
};

#define PAIR(text, access_, way) \
	PROPERTY(text, BITS, VOLATILE, access_, AGGREGATE(2, NUMBERS), .how = (way))

static const struct property properties[] = {
	PROPERTY_BRANCH("aux", .arg = COUPLER_AUX),
	PAIR("branch", BOTH, WAY_BRANCH),
	PROPERTY("clearevent", YESNO, STABLE, WRITE, .how = WAY_CLEAR),
	PROPERTY("control", UNSIGNED, STABLE, BOTH, .how = WAY_CONTROL),
	PROPERTY("discharge", YESNO, STABLE, WRITE, .how = WAY_DISCHARGE),
	PAIR("event", READ, WAY_EVENT),
	PROPERTY_BRANCH("main", .arg = COUPLER_MAIN),
	PAIR("sensed", READ, WAY_SENSED),
};

CHIP_FAMILY(1f, "DS2409", PRESENCE, .alarms = true, HOW(how), PROPERTIES(properties));
