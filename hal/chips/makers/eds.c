/* SPDX-License-Identifier: MIT */
/*
 * Sensors of Embedded Data Systems: which one it is, its pages, its relay and LED, its alarms and
 * counters. The memory maps of its manuals could not be had: commands, addresses and units are
 * those of OWFS's driver and manual page.
 *
 * A page has a CRC16, and so has a write, whose scratchpad is read back before the copy, and whose
 * page after it. Counters and latches of an EDS0090 are looked at before and after their reset.
 * Nothing shows Clear Alarms: it is sent three times, and reads a page of the sensor then.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/field.h"
#include "hal/chips/makers/eds.h"

enum { PAGE = 32, ID_AT = 0x1e };
enum { LATCHES_AT = 0x23, PULSES_AT = 0x30, COUNTERS = 8 };
enum { PULSE_RESET = 4, LATCH_RESET = 5, STATE = 15 }; /* in eds_switches */
#define CLEAR_ALARMS 0x33
#define AS_WRITTEN 2 /* of two bits of the function: neither alarms nor "off" decide */
/* A lost command leaves no trace but in what it did: it is given so many times. */
#define CLEAR_TIMES 3

/* What is known of the sensor (device.own). */
struct eds {
	uint32_t seconds; /* that it ran when they were last read */
};

struct visit {
	uint8_t at; /* where the bytes stand that were read last */
	uint8_t stage;
	uint8_t latches; /* before they are reset */
	uint32_t pulses[COUNTERS];
};

static bool is_octal(unsigned kind)
{
	return kind >= EDS0080 && kind <= EDS0085;
}

static uint8_t kind_of_id(unsigned id)
{
	static const uint8_t ids[EDS_OTHER] = {0,    0x64, 0x65, 0x66, 0x67, 0x68, 0x70,
	                                       0x71, 0x72, 0x80, 0x82, 0x83, 0x85, 0x90};
	uint8_t kind = EDS0064;

	while (kind < EDS_OTHER && ids[kind] != id)
		kind++;
	return kind;
}

int eds_identify(struct txn *txn)
{
	uint8_t page[PAGE];
	int err = area_fetch(txn, &eds_memory, 0, page, PAGE);

	if (!err)
		txn->device->kind = kind_of_id(page[ID_AT] | (unsigned)page[ID_AT + 1] << 8);
	return err;
}

/* The seconds since it was switched on: fewer than before prove a restart. */
static int saw_page(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	struct eds *chip = txn->device->own;
	struct visit *visit = txn_own(txn, struct visit);
	unsigned kind = txn->device->kind, clock = kind >= EDS0080 ? 0x2c : 0x3c;

	visit->at = (uint8_t)at;
	if (kind != EDS_OTHER && at <= clock && clock + 4 <= at + n) {
		uint32_t seconds = area_le32(bytes + clock - at);

		txn->restarted |= seconds < chip->seconds;
		chip->seconds = seconds;
	}
	return 0;
}

/* The state of what is left to the alarms changes by itself. */
static uint8_t states_that_count(uint8_t function)
{
	uint8_t mask = 0xfc;

	for (unsigned i = 0; i < 2; i++)
		if ((function >> (2 * i) & 3) == AS_WRITTEN)
			mask |= (uint8_t)(1 << i);
	return mask;
}

/* state: where the state stands, behind the function; n: nowhere. */
static bool is_equal_but_state(const uint8_t *have, const uint8_t *want, unsigned n, unsigned state)
{
	for (unsigned i = 0; i < n; i++) {
		uint8_t mask = i == state ? states_that_count(want[i - 1]) : 0xff;

		if ((have[i] ^ want[i]) & mask)
			return false;
	}
	return true;
}

static bool page_is_written(struct txn *txn, const uint8_t *have, const uint8_t *want, unsigned n)
{
	const struct visit *visit = txn_own(txn, struct visit);
	unsigned last = is_octal(txn->device->kind) ? 0x80 : 0x40;

	return is_equal_but_state(have, want, n, visit->at == last ? n - 1 : n);
}

/* What resets something is not kept. */
static bool switches_are_written(struct txn *txn, const uint8_t *have, const uint8_t *want,
                                 unsigned n)
{
	(void)txn;
	return is_equal_but_state(have, want, PULSE_RESET, n) &&
	       is_equal_but_state(have + LATCH_RESET + 1, want + LATCH_RESET + 1,
	                          n - LATCH_RESET - 1, STATE - LATCH_RESET - 1);
}

/* Nothing is reset by the way. */
static void reset_nothing_else(struct txn *txn, uint8_t *want)
{
	const struct property *property = txn->property;

	for (unsigned i = PULSE_RESET; i <= LATCH_RESET; i++)
		if (property->type != PROPERTY_BINARY && property->field.at != i)
			want[i] = 0;
}

/*
 * A page is always written to its end: then the sensor answers with a checksum. It takes the copy
 * within 700 ms, and the old bytes are read until then.
 */
#define PAGES \
	.address_bytes = 2, .read = 0xa5, .check = AREA_CRC16, .write = 0x0f, .verify = 0xaa, \
	.copy = 0x55, .write_crc16 = true, .copy_ns = 700 * TXN_MS

AREA_NAMED(eds_memory, "memory", .size = 5 * PAGE, .block = PAGE, .row = PAGE, PAGES,
           .saw = saw_page, .is_written = page_is_written);

AREA_NAMED(eds_switches, "switches", .at = EDS_SWITCHES_AT, .size = 16, .block = 16, .row = 16,
           PAGES, .is_written = switches_are_written, .adjust = reset_nothing_else);

/* The text without the blanks and zeros behind it. */
int eds_read_tag(struct txn *txn)
{
	uint8_t page[PAGE];
	unsigned n = txn->property->size;
	int err = area_read(txn, &eds_memory, 0, page, n);

	if (err)
		return err;
	while (n && (page[n - 1] == '\0' || page[n - 1] == ' '))
		n--;
	if (n > txn->room)
		return -EMSGSIZE;
	memcpy(txn->data, page, n);
	txn->len = n;
	return 0;
}

int eds_read_type(struct txn *txn)
{
	uint8_t id[2];
	int err = area_read(txn, &eds_memory, ID_AT, id, sizeof(id));

	if (!err)
		txn->len = (size_t)snprintf((char *)txn->data, txn->room, "EDS%02X%02X", id[1],
		                            id[0]);
	return err;
}

/* The sensor measures into the other pages. */
int eds_write_memory(struct txn *txn)
{
	unsigned at = (unsigned)txn->element * PAGE + (unsigned)txn->at, n = (unsigned)txn->len;
	unsigned kind = txn->device->kind;
	unsigned first = is_octal(kind) ? 0x60 : kind == EDS0090 ? EDS_SWITCHES_AT : 0x40;
	unsigned end = is_octal(kind) ? 0xa0 : 0x60;

	if (kind == EDS_OTHER || at < first || at + n > end)
		return -EOPNOTSUPP;
	return kind == EDS0090 ? area_write(txn, &eds_switches, at - first, txn->data, NULL, n)
	                       : area_write(txn, &eds_memory, at, txn->data, NULL, n);
}

int eds_read_pairs(struct txn *txn)
{
	const struct field *field = &txn->property->field;
	uint8_t bytes[2];
	int err = area_read(txn, family_area(txn), field->at, bytes, sizeof(bytes));

	if (err)
		return err;
	txn->bits = 0;
	for (unsigned i = 0; i < txn->property->array.count; i++)
		txn->bits |= ((unsigned)(bytes[i / 4] >> (2 * (i % 4) + field->shift)) & 1) << i;
	return 0;
}

int eds_write_pairs(struct txn *txn)
{
	const struct field *field = &txn->property->field;
	uint8_t bytes[2] = {0}, which[2] = {0};

	for (unsigned i = 0; i < txn->property->array.count; i++) {
		uint8_t bit = (uint8_t)(1 << (2 * (i % 4) + field->shift));

		if (txn->one && i != (unsigned)txn->element)
			continue;
		which[i / 4] |= bit;
		bytes[i / 4] |= txn->bits >> i & 1 ? bit : 0;
	}
	return area_write(txn, family_area(txn), field->at, bytes, which, sizeof(bytes));
}

int eds_write_state(struct txn *txn)
{
	const struct field *field = &txn->property->field;
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t which = field->bits ? (uint8_t)(1 << field->shift) : 3, function, state;
	int err;

	if (visit->stage) {
		state = (uint8_t)((unsigned)txn->number[0] << field->shift);
		return area_write(txn, family_area(txn), field->at, &state, &which, 1);
	}
	if (txn->number[0] > (field->bits ? 1 : 3))
		return -EINVAL;
	err = area_read(txn, family_area(txn), field->at - 1u, &function, 1);
	if (err)
		return err;
	visit->stage = 1;
	return which & ~states_that_count(function) ? -EOPNOTSUPP : TXN_MORE;
}

/* Is what was to be reset as it was before? */
static bool is_unchanged(struct txn *txn, const uint8_t *page, unsigned first)
{
	const struct visit *visit = txn_own(txn, struct visit);
	uint32_t which = txn->one ? txn->bits & 1u << txn->element : txn->bits;
	bool unchanged = false;

	if (txn->property->field.at == LATCH_RESET)
		return first == 0 && (page[LATCHES_AT - PAGE] & visit->latches & which);
	for (unsigned i = first; i < first + 4; i++) {
		const uint8_t *pulses = first ? page + 4 * (i - 4)
		                              : page + PULSES_AT - PAGE + 4 * i;

		if (which >> i & 1 && visit->pulses[i])
			unchanged |= area_le32(pulses) >= visit->pulses[i];
	}
	return unchanged;
}

static void note_counters(struct visit *visit, const uint8_t *page, unsigned first)
{
	if (!first)
		visit->latches = page[LATCHES_AT - PAGE];
	for (unsigned i = 0; i < 4; i++)
		visit->pulses[first + i] = area_le32(page + (first ? 0 : PULSES_AT - PAGE) + 4 * i);
}

/* A reset leaves no trace in the register: the counters and latches before and after prove it. */
int eds_write_reset(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	unsigned first = visit->stage % 3 ? 4 : 0;
	uint8_t page[PAGE] = {0};
	int err;

	if (visit->stage == 2) {
		uint8_t bits = (uint8_t)txn->bits;
		uint8_t which = txn->one ? (uint8_t)(1 << txn->element) : 0xff;

		err = area_write(txn, &eds_switches, txn->property->field.at, &bits, &which, 1);
	} else {
		err = area_fetch(txn, &eds_memory, (first ? 2 : 1) * PAGE, page, PAGE);
	}
	if (err)
		return err;
	if (visit->stage < 2)
		note_counters(visit, page, first);
	else if (visit->stage > 2 && is_unchanged(txn, page, first))
		return -EIO;
	return ++visit->stage > 4 ? 0 : TXN_MORE;
}

int eds_write_clear(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t page[PAGE];

	if (txn->number[0] == 0)
		return 0;
	if (visit->stage == CLEAR_TIMES)
		return area_fetch(txn, &eds_memory, PAGE, page, PAGE); /* the sensor is there */
	int err = txn_command(txn, TXN_BYTES(CLEAR_ALARMS));
	txn_void(txn);
	visit->stage++;
	return err ? err : TXN_MORE;
}
