/* SPDX-License-Identifier: MIT */
/* The two pins of DS2413 and DS28EA00. */
#include <errno.h>
#include <string.h>

#include "hal/chips/switches/pio.h"

#define READ_PIO 0xf5
#define CONFIRMED 0xaa

/*
 * A byte's halves are each other's complement, which two bits turned over get past. It is sent as
 * long as the master reads: two that follow each other have to be the same.
 */
static int read_status(struct txn *txn)
{
	static const uint8_t command = READ_PIO;
	uint8_t status[3];
	int err = txn_ask(txn, &command, 1, status, sizeof(status));

	if (err)
		return err;
	bool twice = status[1] == status[0] || status[1] == status[2];
	return twice && (status[1] & 0xf) == (~status[1] >> 4 & 0xf) ? status[1] & 0xf : -EBADMSG;
}

/* The pins, the latches, and the nibble itself. */
static int load_status(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                       unsigned n)
{
	int status = read_status(txn);
	const uint8_t parts[] = {(uint8_t)((status & 1) | (status >> 1 & 2)),
	                         (uint8_t)((status >> 1 & 1) | (status >> 2 & 2)), (uint8_t)status};

	(void)area;
	memcpy(bytes, parts + at, n);
	return status < 0 ? status : 0;
}

const struct area pio_status = {.name = "status", .size = 3, .block = 3, .load = load_status};

int pio_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n)
{
	return load_status(txn, area, 1 + at, bytes, n);
}

/* The byte and its complement, the confirmation, the status. */
int pio_store(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
              unsigned n)
{
	uint8_t byte = bytes[0] | 0xfc, command[] = {area->write, byte, (uint8_t)~byte}, answer[2];
	int err = txn_ask(txn, command, sizeof(command), answer, sizeof(answer));

	(void)at, (void)n;
	return err ? err : answer[0] == CONFIRMED ? 0 : -EBADMSG;
}

bool pio_is_written(struct txn *txn, const uint8_t *have, const uint8_t *want, unsigned n)
{
	(void)txn, (void)n;
	return ((have[0] ^ want[0]) & 3) == 0;
}
