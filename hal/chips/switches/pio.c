/* SPDX-License-Identifier: MIT */
/* The two pins of DS2413 and DS28EA00. */
#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/switches/pio.h"

#define READ_PIO 0xf5
#define CONFIRMED 0xaa

/* An emulated DS2413 (OneWireHub): so many readings in a row, each of so many looks. */
#define COPY_READINGS 3
#define COPY_LOOKS 3
#define COPY_LOOKS_MOST 8

static bool is_status(uint8_t byte)
{
	return (byte & 0xf) == (~byte >> 4 & 0xf);
}

/*
 * A program that plays a DS2413 sends its status once, and then ones, which the chip never does:
 * one that is interrupted does so now and then. Where it does it again and again, and never as the
 * chip, it is such a copy, and its status is good when three looks show the same.
 */
static int look_at_copy(struct txn *txn, uint8_t status)
{
	struct looks {
		uint8_t same, all, last;
	} *looks = txn_own(txn, struct looks);
	struct pio_copy *copy = txn->device->own;

	looks->same = looks->all && looks->last == status ? looks->same + 1 : 1;
	looks->last = status;
	if (looks->same < COPY_LOOKS)
		return ++looks->all < COPY_LOOKS_MOST ? TXN_MORE : -EBADMSG;
	if (copy->readings < COPY_READINGS && ++copy->readings < COPY_READINGS)
		return -EBADMSG;
	memset(looks, 0, sizeof(*looks));
	txn->device->identity = "emulated: sends its status once";
	return 0;
}

/*
 * A byte's halves are each other's complement, which two bits turned over get past. It is sent as
 * long as the master reads: two that follow each other have to be the same.
 */
static int read_status(struct txn *txn, uint8_t *nibble)
{
	uint8_t status[3];
	int err = txn_ask(txn, TXN_BYTES(READ_PIO), status, sizeof(status));

	if (err)
		return err;
	struct pio_copy *copy = txn->device->family->thermometer ? NULL : txn->device->own;
	bool twice = status[1] == status[0] || status[1] == status[2];

	bool is_genuine = twice && is_status(status[1]);

	*nibble = status[is_genuine] & 0xf;
	if (is_genuine) {
		if (copy) {
			*copy = (struct pio_copy){0};
			txn->device->identity = NULL;
		}
		return 0;
	}
	if (!copy || !is_status(status[0]) || (status[1] & status[2]) != 0xff)
		return -EBADMSG;
	return look_at_copy(txn, status[0]);
}

/* The pins, the latches, and the nibble itself. */
static int load_status(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                       unsigned n)
{
	uint8_t status = 0;
	int err = read_status(txn, &status);
	const uint8_t parts[] = {(uint8_t)((status & 1) | (status >> 1 & 2)),
	                         (uint8_t)((status >> 1 & 1) | (status >> 2 & 2)), status};

	(void)area;
	memcpy(bytes, parts + at, n);
	return err;
}

AREA_NAMED(pio_status, "status", .size = 3, .block = 3, .load = load_status);

int pio_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n)
{
	return load_status(txn, area, 1 + at, bytes, n);
}

static bool is_copy(const struct device *device)
{
	const struct pio_copy *copy = device->own;

	return !device->family->thermometer && copy->readings == COPY_READINGS;
}

/* It did not confirm a write. Is it a copy? */
static bool is_asked(const struct device *device)
{
	const struct pio_copy *copy = device->own;

	return !device->family->thermometer && copy->asked && copy->readings < COPY_READINGS;
}

/* Of a copy it takes several readings until it is known as one. */
static int look_before(struct txn *txn)
{
	const struct pio_copy *copy = txn->device->own;
	uint8_t before = copy->readings, nibble;
	int err = read_status(txn, &nibble);

	if (err && (err != -EBADMSG || copy->readings == before))
		return err;
	memset(txn->own, 0, sizeof(txn->own));
	return TXN_MORE;
}

/*
 * The byte and its complement, the confirmation, the status. A copy confirms nothing: what it shows
 * after that is all.
 */
int pio_store(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
              unsigned n)
{
	uint8_t byte = bytes[0] | 0xfc, command[] = {area->write, byte, (uint8_t)~byte}, answer[2];

	bool blank = txn->blank;

	if (is_asked(txn->device))
		return look_before(txn);
	int err = txn_ask(txn, command, sizeof(command), answer, sizeof(answer));

	(void)at, (void)n;
	if (!err && answer[0] == 0xff && !txn->device->family->thermometer) {
		struct pio_copy *copy = txn->device->own;

		copy->asked = true;
		txn->blank = blank;
		return is_copy(txn->device) ? 0 : -EBADMSG;
	}
	return err ? err : answer[0] == CONFIRMED ? 0 : -EBADMSG;
}

bool pio_is_written(struct txn *txn, const uint8_t *have, const uint8_t *want, unsigned n)
{
	(void)txn, (void)n;
	return ((have[0] ^ want[0]) & 3) == 0;
}
