/* SPDX-License-Identifier: MIT */
/*
 * What runs in a BAE 0911: a command starts it, and a query gives its result. The commands that end
 * something give no bytes, so that an old result is not taken for the next one's.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/makers/bae.h"

#define BLOCK 32
#define SECTOR 512
#define EXPANDER 0x40 /* CAT9554 on the I2C */
#define BUSY 0xff
#define SOON_NS (2 * TXN_MS)
#define LOOKS 50
#define PASSES 2

enum { RUN = 0x17, SEND, RECEIVE, QUERY };
enum { BEGIN_I2C, END_I2C, BEGIN_WRITE, END_WRITE, BEGIN_READ, END_READ };
enum { CARD_WRITE = 2, CARD_READ = 0 };

#define CONFIRM 0xbc
#define HEAD 32 /* bytes of a command that are written at once */

int bae_confirmed(struct txn *txn, const uint8_t *command, unsigned n)
{
	static const uint8_t confirm = CONFIRM;
	uint8_t none;
	unsigned head = n < HEAD ? n : HEAD;
	int err = txn_command(txn, command, head);

	for (unsigned done = head; !err && done < n; done += head) {
		head = n - done < HEAD ? n - done : HEAD;
		err = txn_write(txn, command + done, head);
	}
	if (!err)
		err = txn_read_crc16(txn, command, n, &none, 0);
	return err ? err : txn_write(txn, &confirm, 1);
}

/* From call to call. */
struct run {
	uint8_t step;  /* of the property */
	uint8_t looks; /* at the command that runs; 0: it has to be started */
	uint8_t pass;
	uint8_t chunk;
	uint8_t bytes[BLOCK];
};

/* 0: it is done, and has given n bytes. */
static int query_result(struct txn *txn, uint8_t *bytes, unsigned n)
{
	struct run *run = txn_own(txn, struct run);
	uint8_t head[3] = {QUERY};
	int err = txn_ask(txn, head, 1, head + 1, 2);

	if (err)
		return err;
	if (head[1] == BUSY)
		return run->looks++ < LOOKS ? txn_wait(txn, SOON_NS) : -EBADMSG;
	if (head[2] > BLOCK)
		return -EBADMSG;
	err = txn_read_crc16(txn, head, sizeof(head), run->bytes, head[2]);
	if (err)
		return err;
	if (head[1] != 0 || head[2] != n)
		return head[1] ? -EIO : -EBADMSG;
	memcpy(bytes, run->bytes, n);
	run->looks = 0;
	return 0;
}

/* Start the command, then ask until it is done; 0: it is, and has given out_n bytes. */
static int do_command(struct txn *txn, const uint8_t *command, unsigned n, uint8_t *out,
                      unsigned out_n)
{
	struct run *run = txn_own(txn, struct run);
	int err;

	if (run->looks)
		return query_result(txn, out, out_n);
	run->looks = 1;
	err = bae_confirmed(txn, command, n);
	return err ? err : txn_wait(txn, SOON_NS);
}

static int start_function(struct txn *txn, uint8_t function, const uint8_t *in, unsigned n,
                          uint8_t *out, unsigned out_n)
{
	uint8_t command[4 + 4] = {RUN, (uint8_t)n, function, (uint8_t)out_n};

	if (n)
		memcpy(command + 4, in, n);
	return do_command(txn, command, 4 + n, out, out_n);
}

/* The step is over; TXN_MORE: there are others. */
static int next_step(struct txn *txn, int err)
{
	struct run *run = txn_own(txn, struct run);

	if (err)
		return err;
	run->step++;
	return TXN_MORE;
}

/* arg: the register. Ending gives no bytes: so a lost beginning is seen. */
int bae_read_expander(struct txn *txn)
{
	const uint8_t in[] = {EXPANDER, (uint8_t)txn->property->arg};
	struct run *run = txn_own(txn, struct run);
	uint8_t byte = 0, none[1];
	int err;

	switch (run->step) {
	case 0:
		return next_step(txn, start_function(txn, END_I2C, NULL, 0, none, 0));
	case 1:
		err = start_function(txn, BEGIN_I2C, in, sizeof(in), &byte, 1);
		if (!err)
			run->pass = byte;
		return next_step(txn, err);
	}
	err = start_function(txn, END_I2C, NULL, 0, none, 0);
	txn->number[0] = run->pass;
	return err;
}

/* It is read back: a lost command shows. */
int bae_write_expander(struct txn *txn)
{
	const uint8_t value = (uint8_t)txn->number[0];
	const uint8_t in[] = {EXPANDER, (uint8_t)txn->property->arg, value};
	struct run *run = txn_own(txn, struct run);
	uint8_t byte = 0, none[1];
	int err;

	if (txn->number[0] > 0xff)
		return -EINVAL;
	switch (run->step) {
	case 0:
		return next_step(txn, start_function(txn, BEGIN_I2C, in, sizeof(in), none, 0));
	case 1:
	case 3:
		err = next_step(txn, start_function(txn, END_I2C, NULL, 0, none, 0));
		return run->step == 4 ? 0 : err;
	}
	err = start_function(txn, BEGIN_I2C, in, 2, &byte, 1);
	return err ? err : byte == value ? next_step(txn, 0) : -EIO;
}

int bae_read_sector_number(struct txn *txn)
{
	txn->number[0] = ((const struct bae *)txn->device->own)->sector;
	return 0;
}

int bae_write_sector_number(struct txn *txn)
{
	if (txn->number[0] > UINT32_MAX / SECTOR)
		return -EINVAL;
	((struct bae *)txn->device->own)->sector = (uint32_t)txn->number[0];
	return 0;
}

static int begin_sector(struct txn *txn, uint8_t function)
{
	uint32_t at = ((const struct bae *)txn->device->own)->sector * SECTOR;
	const uint8_t in[] = {(uint8_t)(at >> 24), (uint8_t)(at >> 16), (uint8_t)(at >> 8),
	                      (uint8_t)at};
	uint8_t none[1];

	return start_function(txn, function, in, sizeof(in), none, 0);
}

/* A lost confirmation gives a block twice: so the sector is read twice. first: the first time. */
static int read_blocks(struct txn *txn, bool first)
{
	static const uint8_t command[] = {RECEIVE, BLOCK, CARD_READ};
	struct run *run = txn_own(txn, struct run);
	uint8_t block[BLOCK], *to = txn->data + run->chunk * BLOCK;
	int err = do_command(txn, command, sizeof(command), block, BLOCK);

	if (err)
		return err;
	if (!first && memcmp(to, block, BLOCK) != 0)
		return -EBADMSG;
	memcpy(to, block, BLOCK);
	if (++run->chunk < SECTOR / BLOCK)
		return TXN_MORE;
	run->chunk = 0;
	return 0;
}

/* Steps 0 to 2, again and again until the passes are made. */
static int read_sector(struct txn *txn, unsigned from, bool compare)
{
	struct run *run = txn_own(txn, struct run);
	uint8_t none[1];
	int err;

	switch (run->step - from) {
	case 0:
		return next_step(txn, begin_sector(txn, BEGIN_READ));
	case 1:
		return next_step(txn, read_blocks(txn, run->pass == 0 && !compare));
	}
	err = start_function(txn, END_READ, NULL, 0, none, 0);
	if (err)
		return err;
	run->step = (uint8_t)from;
	return ++run->pass < (compare ? 1 : PASSES) ? TXN_MORE : 0;
}

int bae_read_sector(struct txn *txn)
{
	int err = read_sector(txn, 0, false);

	if (!err)
		txn->len = SECTOR;
	return err;
}

/* Written, then read and compared. */
int bae_write_sector(struct txn *txn)
{
	struct run *run = txn_own(txn, struct run);
	uint8_t command[3 + BLOCK] = {SEND, BLOCK, CARD_WRITE}, none[1];
	int err;

	if (txn->at || txn->len != SECTOR)
		return -EINVAL;
	switch (run->step) {
	case 0:
		return next_step(txn, begin_sector(txn, BEGIN_WRITE));
	case 1:
		memcpy(command + 3, txn->data + run->chunk * BLOCK, BLOCK);
		err = do_command(txn, command, sizeof(command), none, 0);
		if (err)
			return err;
		if (++run->chunk < SECTOR / BLOCK)
			return TXN_MORE;
		run->chunk = 0;
		return next_step(txn, 0);
	case 2:
		return next_step(txn, start_function(txn, END_WRITE, NULL, 0, none, 0));
	}
	err = read_sector(txn, 3, true);
	return err == -EBADMSG ? -EIO : err;
}

/* arg: to whom. Nothing shows that it arrived. */
int bae_write_text(struct txn *txn)
{
	struct run *run = txn_own(txn, struct run);
	size_t at = (size_t)run->chunk * BLOCK, n = txn->len - at < BLOCK ? txn->len - at : BLOCK;
	uint8_t command[3 + BLOCK] = {SEND, (uint8_t)n, (uint8_t)txn->property->arg}, none[1];

	if (txn->len == 0)
		return 0;
	if (txn->at)
		return -EINVAL;
	memcpy(command + 3, txn->data + at, n);
	int err = do_command(txn, command, (unsigned)(3 + n), none, 0);
	if (err)
		return err;
	run->chunk++;
	return at + n < txn->len ? TXN_MORE : 0;
}
