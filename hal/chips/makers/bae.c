/* SPDX-License-Identifier: MIT */
/* BAE 0910 and 0911: which one is it, its memory by blocks, commands that are confirmed. */
#include <errno.h>
#include <string.h>

#include "hal/chips/makers/bae.h"

#define CONFIRM 0xbc
#define HEAD 32 /* bytes of a command that are written at once */
#define EEPROM_910 0xe000

enum { READ_TYPE = 0x12, READ_BLOCK = 0x14, WRITE_BLOCK };

int bae_identify(struct txn *txn)
{
	static const uint8_t command = READ_TYPE;
	uint8_t type[2];
	int err = txn_ask_crc16(txn, &command, 1, type, sizeof(type));

	if (!err)
		txn->device->kind = type[0] == 2 ? BAE_910 : type[0] == 3 ? BAE_911 : BAE_OTHER;
	return err;
}

/* The EEPROM of a 0910 stands elsewhere. */
static unsigned bae_address(const struct txn *txn, const struct area *area, unsigned at)
{
	bool moved = area->size > 0x3000 && txn->device->kind == BAE_910;

	return area->at + at + (moved ? EEPROM_910 : 0);
}

int bae_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n)
{
	unsigned where = bae_address(txn, area, at);
	const uint8_t command[] = {READ_BLOCK, (uint8_t)where, (uint8_t)(where >> 8), (uint8_t)n};
	return txn_ask_crc16(txn, command, sizeof(command), bytes, n);
}

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

int bae_store(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
              unsigned n)
{
	unsigned where = bae_address(txn, area, at);
	uint8_t command[4 + AREA_UNIT] = {WRITE_BLOCK, (uint8_t)where, (uint8_t)(where >> 8),
	                                  (uint8_t)n};

	memcpy(command + 4, bytes, n);
	return bae_confirmed(txn, command, 4 + n);
}
