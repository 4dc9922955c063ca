/* SPDX-License-Identifier: MIT */
/* DS2430A (data sheet 19-5235): 32 bytes of EEPROM, and 8 that can be written once. */
#include <errno.h>
#include <string.h>

#include "hal/chips/memory.h"

#define READ_MEMORY 0xf0
#define WRITE_SCRATCHPAD 0x0f
#define READ_SCRATCHPAD 0xaa
#define COPY_SCRATCHPAD 0x55
#define WRITE_APPLICATION 0x99
#define READ_APPLICATION 0xc3
#define COPY_AND_LOCK 0x5a
#define READ_STATUS 0x66
#define KEY 0xa5
#define COPY_NS (10 * TXN_MS)

struct area {
	uint8_t size, read, write, verify, copy;
};
static const struct area areas[] = {
	{32, READ_MEMORY, WRITE_SCRATCHPAD, READ_SCRATCHPAD, COPY_SCRATCHPAD},
	{8, READ_APPLICATION, WRITE_APPLICATION, READ_APPLICATION, COPY_AND_LOCK},
};

static int read_bytes(struct txn *txn, uint8_t code, uint8_t *bytes, unsigned n)
{
	uint8_t command[] = {code, 0x00};
	int err = txn_command(txn, command, sizeof(command));

	return err ? err : txn_read(txn, bytes, n);
}

static int look(struct txn *txn, unsigned number, uint8_t code, unsigned n)
{
	uint8_t command[] = {code, 0x00};

	return memory_look(txn, number, command, sizeof(command), txn->mem, n);
}

static int read_area(struct txn *txn)
{
	const struct area *area = &areas[txn->property->arg];
	int err = look(txn, txn->phase++, area->read, area->size);

	if (err)
		return err;
	memcpy(txn->data, txn->mem, area->size);
	txn->len = area->size;
	return 0;
}

/* The looks also fill the scratchpad with what is there. */
static int write_area(struct txn *txn)
{
	enum { WRITE = MEMORY_LOOKS, VERIFY, COPY };
	const struct area *area = &areas[txn->property->arg];
	uint8_t command[34] = {area->write, 0x00}, in[32];
	static const uint8_t key = KEY;
	unsigned step = txn->phase++;
	int err;

	switch (step) {
	case WRITE:
		memcpy(command + 2, txn->mem, area->size);
		err = txn_command(txn, command, 2u + area->size);
		return err ? err : TXN_MORE;
	case VERIFY:
		err = read_bytes(txn, area->verify, in, area->size);
		return err ? err : memcmp(in, txn->mem, area->size) == 0 ? TXN_MORE : -EBADMSG;
	case COPY:
		err = txn_command(txn, &area->copy, 1);
		return err ? err : txn_write_strong(txn, &key, 1, COPY_NS);
	case COPY + 1:
		err = read_bytes(txn, area->read, in, area->size);
		return err ? err : memcmp(in, txn->mem, area->size) == 0 ? 0 : -EIO;
	default:
		err = look(txn, step, area->read, area->size);
		txn->silent = false;
		if (err)
			return err;
		memcpy(in, txn->mem, area->size);
		memcpy(txn->mem + txn->at, txn->data, txn->len);
		return memcmp(in, txn->mem, area->size) == 0 ? 0 : TXN_MORE;
	}
}

static int read_status(struct txn *txn)
{
	int err = look(txn, txn->phase++, READ_STATUS, 1);

	txn->number[0] = txn->mem[0];
	txn->silent = false;
	return err;
}

/* clang-format off */
#define AREA(text, bytes, life_, which)                                                   \
	{.name = (text), .type = PROPERTY_BINARY, .life = (life_), .access = ACCESS_BOTH,   \
	 .size = (bytes), .arg = (which), .read = read_area, .write = write_area}

static const struct property properties[] = {
	AREA("application", 8, LIFE_STABLE, 1),
	AREA("memory", 32, LIFE_VOLATILE, 0),
	{.name = "status", .type = PROPERTY_UNSIGNED, .life = LIFE_STABLE, .access = ACCESS_READ,
	 .read = read_status},
};
/* clang-format on */

const struct family family_14 = {.code = 0x14, .type = "DS2430A", PROPERTIES(properties)};
