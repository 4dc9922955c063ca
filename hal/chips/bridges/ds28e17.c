/* SPDX-License-Identifier: MIT */
/*
 * DS28E17: a packet with a CRC16 says what to do on the I2C bus. No data sheet could be had: the
 * facts are those of published drivers (the kernel's w1_ds28e17, the maker's library).
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/bridges/ds28e17.h"
#include "hal/wire/crc.h"

enum { WRITE_STOP = 0x4b, READ_STOP = 0x87, WRITE_READ_STOP = 0x2d };
enum { BAD_CRC = 0x01 }; /* status; the others: no sensor took the address */

/* 100 kHz take 90 us a byte, a read slot 70 us at the least. */
#define SLOTS(bytes) (40 + 2 * (bytes))

/* Read slots are 1 while it is busy; a 0 stands before the answer. */
static int ds28e17_await(struct txn *txn, unsigned slots)
{
	int bit = 1;

	while (bit == 1 && slots--)
		bit = txn_bit(txn);
	return bit == 1 ? -EBADMSG : bit;
}

int ds28e17_exchange(struct txn *txn, const struct i2c_transfer *transfer)
{
	uint8_t command[6 + I2C_AT_ONCE], answer[2 + I2C_AT_ONCE];
	unsigned n = transfer->n, m = transfer->m, len = 0, status = n ? 2 : 1;
	int err;

	command[len++] = !m ? WRITE_STOP : n ? WRITE_READ_STOP : READ_STOP;
	command[len++] = (uint8_t)(transfer->address << 1 | !n);
	command[len++] = (uint8_t)(n ? n : m);
	if (n)
		memcpy(command + len, transfer->out, n);
	len += n;
	if (n && m)
		command[len++] = (uint8_t)m;
	uint16_t crc = (uint16_t)~onewire_crc16(0, command, len);
	command[len++] = (uint8_t)crc;
	command[len++] = (uint8_t)(crc >> 8);
	err = txn_command(txn, command, len);
	if (!err)
		err = ds28e17_await(txn, SLOTS(n + m));
	/* That the command was right is a zero. */
	if (!err)
		err = m ? txn_read(txn, answer, status + m) : txn_read_slots(txn, answer, status);
	if (err)
		return err;
	if (answer[0] & BAD_CRC)
		return -EBADMSG;
	if (answer[0] || (n && answer[1]))
		return -EIO;
	if (m)
		memcpy(transfer->in, answer + status, m);
	return 0;
}
