/* SPDX-License-Identifier: MIT */
/*
 * The bridges from 1-Wire to I2C.
 *
 * A packet that is lost leaves ones, and perhaps the sensor's last result. Of a DS28E17 the 0
 * before the answer, and its status, prove it (docs/bridges.md); of a DS28E18 the CRC16 behind each
 * packet and of each answer, and what stands before the bytes in its sequencer.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/bridges/i2c.h"
#include "hal/owfs/path.h"
#include "hal/wire/crc.h"

/*
 * DS28E17: a packet with a CRC16 says what to do on the I2C bus. No data sheet could be had: the
 * facts are those of published drivers (the kernel's w1_ds28e17, the maker's library).
 */
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

/*
 * DS28E18: commands for the I2C bus stand in a sequencer, which is written, run, and read. The
 * facts are those of the maker's application note 7356 and of published drivers (EXACT's for
 * Zephyr, MCCI's, Maxim's library); no whole data sheet could be had.
 *
 * After power-on its id is 56h with zeros, until Write GPIO Configuration loads the real one.
 */
/* Behind the start stand the length and a device function. */
enum {
	START = 0x66,
	WRITE_SEQUENCER = 0x11,
	READ_SEQUENCER = 0x22,
	RUN_SEQUENCER = 0x33,
	WRITE_GPIO = 0x83,
	RELEASE = 0xaa
};
/* Results. */
enum { DONE = 0xaa, RESTARTED = 0x44, NOT_ACKNOWLEDGED = 0x88 };
/* Of the sequencer: the supply of the sensors on; I2C. */
enum { SUPPLY_ON = 0xcc, I2C_START = 0x02, I2C_STOP = 0x03, I2C_WRITE = 0xe3, I2C_READ = 0xd3 };

#define MATCH_ROM 0x55
#define PACKET 62
#define OPERATION_NS (2 * TXN_MS)
#define BYTE_NS INT64_C(150000) /* at 100 kHz */
/* SUPPLY_ON, and of a transfer START, write, length, address, START, write, 1, address, read, m */
#define SEQUENCE (12 + 2 * I2C_AT_ONCE)

/*
 * A device function of n bytes, for which the wire gives its power; m bytes of its result get to
 * in. rom NULL: the selected device's.
 */
static int function(struct txn *txn, const uint8_t *rom, const uint8_t *bytes, unsigned n,
                    int64_t ns, uint8_t *in, unsigned m)
{
	uint8_t out[9 + 2 + PACKET], *command = out + 9, answer[4 + 3 + 2 + I2C_AT_ONCE], none;
	unsigned room = m > 2 ? m : 2;
	int err;

	if (n > PACKET)
		return -EINVAL;
	command[0] = START;
	command[1] = (uint8_t)n;
	memcpy(command + 2, bytes, n);
	if (rom) {
		out[0] = MATCH_ROM;
		memcpy(out + 1, rom, 8);
	}
	err = rom ? txn_raw(txn, out, 9 + 2 + n) : txn_command(txn, command, 2 + n);
	if (!err)
		err = txn_read_crc16(txn, command, 2 + n, &none, 0);
	if (!err)
		err = txn_write_paused(txn, TXN_BYTES(RELEASE), ns);
	/* a byte of ones, length, result, m bytes, CRC16 */
	if (!err)
		err = txn_read(txn, answer, 3 + room + 2);
	if (err)
		return err;
	if (answer[0] != 0xff || answer[1] < 1 || answer[1] > 1 + room ||
	    !onewire_crc16_matches(onewire_crc16(0, answer + 1, answer[1] + 1u),
	                           answer + 2 + answer[1]))
		return txn_checked(txn, false);
	if (answer[2] == NOT_ACKNOWLEDGED)
		return -EIO;
	if (answer[2] != DONE || answer[1] != 1 + m)
		return answer[2] == RESTARTED ? -EBADMSG : -EIO;
	memcpy(in, answer + 3, m);
	return 0;
}

/* The sequence of a transfer; *read: where it reads to, behind the command and its length. */
static unsigned sequence(const struct i2c_transfer *transfer, uint8_t *bytes, unsigned *read)
{
	unsigned n = 0;

	bytes[n++] = SUPPLY_ON;
	bytes[n++] = I2C_START;
	bytes[n++] = I2C_WRITE;
	if (transfer->n) {
		bytes[n++] = (uint8_t)(transfer->n + 1);
		bytes[n++] = (uint8_t)(transfer->address << 1);
		memcpy(bytes + n, transfer->out, transfer->n);
		n += transfer->n;
	}
	if (transfer->n && transfer->m) {
		bytes[n++] = I2C_START;
		bytes[n++] = I2C_WRITE;
	}
	if (transfer->m) {
		bytes[n++] = 1;
		bytes[n++] = (uint8_t)(transfer->address << 1 | 1);
		*read = n;
		bytes[n++] = I2C_READ;
		bytes[n++] = (uint8_t)transfer->m;
		memset(bytes + n, 0xff, transfer->m);
		n += transfer->m;
	}
	bytes[n++] = I2C_STOP;
	return n;
}

/* What stands before the bytes shows that the sequencer is the one that ran. */
static int read_result(struct txn *txn, const struct i2c_transfer *transfer, unsigned at)
{
	const uint8_t command[] = {READ_SEQUENCER, (uint8_t)at, (uint8_t)((transfer->m + 2) << 1)};
	uint8_t in[2 + I2C_AT_ONCE] = {0};
	int err = function(txn, NULL, command, sizeof(command), OPERATION_NS, in, transfer->m + 2);

	if (err)
		return err;
	if (in[0] != I2C_READ || in[1] != transfer->m)
		return -EBADMSG;
	memcpy(transfer->in, in + 2, transfer->m);
	return 0;
}

int ds28e18_exchange(struct txn *txn, const struct i2c_transfer *transfer, uint8_t *part)
{
	uint8_t bytes[3 + SEQUENCE] = {WRITE_SEQUENCER, 0, 0};
	unsigned read = 0, n = sequence(transfer, bytes + 3, &read);
	const uint8_t run[] = {RUN_SEQUENCER, 0, (uint8_t)(n << 1), (uint8_t)(n >> 7)};
	int err;

	if (*part == 0)
		err = function(txn, NULL, bytes, 3 + n, OPERATION_NS, bytes, 0);
	else if (*part == 1)
		err = function(txn, NULL, run, sizeof(run), OPERATION_NS + n * BYTE_NS, bytes, 0);
	else
		err = read_result(txn, transfer, read);
	if (err)
		return err;
	if (++*part < 2u + (transfer->m != 0))
		return TXN_MORE;
	*part = 0;
	return 0;
}

bool ds28e18_asleep(const uint8_t rom[8])
{
	static const uint8_t zeros[6];

	return rom[0] == DS28E18_CODE && memcmp(rom + 1, zeros, 6) == 0;
}

int ds28e18_wake(struct txn *txn)
{
	/* pins as they are after power-on */
	uint8_t rom[8] = {DS28E18_CODE}, none;

	rom[7] = rom_crc8(rom, 7);
	return function(txn, rom, TXN_BYTES(WRITE_GPIO, 0x0b, 0x03, 0xa5, 0x0f), OPERATION_NS,
	                &none, 0);
}
