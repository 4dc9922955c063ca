/* SPDX-License-Identifier: MIT */
/* The two pins of DS2413 and DS28EA00. */
#include <errno.h>

#include "hal/chips/pio.h"

#define READ_PIO 0xf5
#define CONFIRMED 0xaa

static int take_status(struct txn *txn, uint8_t status)
{
	struct device *device = txn->device;
	uint8_t latch = (uint8_t)((status >> 1 & 1) | (status >> 2 & 2));

	if ((status & 0xf) != (~status >> 4 & 0xf))
		return -EBADMSG;
	if (device->shadow_known && device->shadow != latch)
		txn->restarted = true;
	device->shadow = latch;
	device->shadow_known = true;
	return status & 0xf;
}

/*
 * A byte's halves are each other's complement, which two bits turned over get past. It is sent as
 * long as the master reads: two that follow each other have to be the same.
 */
static int read_status(struct txn *txn)
{
	static const uint8_t command = READ_PIO;
	uint8_t status[3];
	int err = txn_command(txn, &command, 1);

	if (!err)
		err = txn_read(txn, status, sizeof(status));
	if (err)
		return err;
	return status[1] == status[0] || status[1] == status[2] ? take_status(txn, status[1])
	                                                        : -EBADMSG;
}

int pio_read_state(struct txn *txn)
{
	int status = read_status(txn);

	txn->number[0] = status;
	return status < 0 ? status : 0;
}

int pio_read_pin(struct txn *txn)
{
	int status = read_status(txn);

	txn->bits = (uint32_t)((status & 1) | (status >> 1 & 2));
	return status < 0 ? status : 0;
}

int pio_read_low(struct txn *txn)
{
	int err = pio_read_pin(txn);

	txn->bits ^= 3;
	return err;
}

int pio_read_output(struct txn *txn)
{
	int status = read_status(txn);

	txn->bits = (uint32_t)((status >> 1 & 1) | (status >> 2 & 2)) ^ 3;
	return status < 0 ? status : 0;
}

/* The byte and its complement, the confirmation, the status; then read back by itself. */
static int write_latches(struct txn *txn, unsigned latch)
{
	uint8_t byte = (uint8_t)(latch | 0xfc);
	uint8_t command[] = {(uint8_t)txn->property->arg, byte, (uint8_t)~byte}, answer[2];
	int err;

	txn->device->shadow_known = false;
	if (txn->phase) {
		err = read_status(txn);
		return err < 0 ? err : txn->device->shadow == (latch & 3) ? 0 : -EIO;
	}
	err = txn_command(txn, command, sizeof(command));
	if (!err)
		err = txn_read(txn, answer, sizeof(answer));
	if (err)
		return err;
	txn->phase = 1;
	return answer[0] == CONFIRMED ? TXN_MORE : -EBADMSG;
}

int pio_write_output(struct txn *txn)
{
	return write_latches(txn, ~txn->bits & 3);
}

int pio_write_state(struct txn *txn)
{
	return write_latches(txn, (unsigned)txn->number[0] & 3);
}
