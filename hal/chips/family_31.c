/* SPDX-License-Identifier: MIT */
/*
 * DS2720: protection of a lithium-ion cell (data sheet, "Efficient, Addressable Single-Cell
 * Rechargeable Lithium Protection IC"): registers, and two blocks of EEPROM that can be locked.
 */
#include <errno.h>

#include "hal/chips/family.h"

#define PINS 0x0c /* of the protection register: CC and DC mirror the pins */

/* The pins follow at once, and are nothing that was written. */
static int saw_protection(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)txn, (void)at, (void)n;
	bytes[0] &= (uint8_t)~PINS;
	return 0;
}

#define REGISTERS .address_bytes = 1, .read = 0x69
#define WRITABLE(row_) REGISTERS, .row = (row_), .write = 0x6c

static const struct area memory = {.name = "memory", .size = 256, .block = 32, REGISTERS};
static const struct area protection = {
	.name = "protection",
	.size = 1,
	WRITABLE(1),
	.saw = saw_protection,
};
static const struct area pins = {.name = "pins", .size = 1, REGISTERS};
static const struct area locks = {.name = "locks", .at = 7, .size = 1, REGISTERS};
static const struct area special = {.name = "special", .at = 8, .size = 1, WRITABLE(1)};
/* Read and written by way of its shadow RAM. */
static const struct area eeprom = {
	.name = "EEPROM",
	.size = 0x34,
	.block = 4,
	WRITABLE(4),
	.recall = 0xb8,
	.copy = 0x48,
	.copy_ns = 10 * TXN_MS,
};

static int read_lock(struct txn *txn)
{
	uint8_t byte = 0;
	int err = area_read(txn, &locks, 0, &byte, 1);

	txn->number[0] = byte >> txn->element & 1;
	return err;
}

/* For good: the enabling bit, and the command that has to follow it at once. */
static int write_lock(struct txn *txn)
{
	static const uint8_t enable[] = {0x6c, 0x07, 0x40};
	const uint8_t lock[] = {0x6a, (uint8_t)(0x20 + 0x10 * txn->element)};
	int err = 0;

	if (txn->phase == 0) {
		if (txn->number[0] == 0)
			return -EOPNOTSUPP;
		txn_void(txn);
		err = txn_command(txn, enable, sizeof(enable));
		if (!err)
			err = txn_command(txn, lock, sizeof(lock));
		if (err)
			return err;
		txn->phase = 1;
	}
	err = read_lock(txn);
	return err ? err : txn->number[0] != 0 ? 0 : -EIO;
}

#define FLAG(text, area_, shift_) \
	{ \
		.name = (text), .type = PROPERTY_YESNO, .life = LIFE_VOLATILE, \
		.access = ACCESS_BOTH, FIELD(area_, .shift = (shift_), .bits = 1) \
	}

/* clang-format off */
static const struct property properties[] = {
	FLAG("cc", pins, 3),
	FLAG("ce", protection, 1),
	FLAG("dc", pins, 2),
	FLAG("de", protection, 0),
	FLAG("doc", protection, 4),
	{.name = "lock", .type = PROPERTY_YESNO, .life = LIFE_STABLE, .access = ACCESS_BOTH,
	 .array = {2, INDEX_NUMBERS, false}, .read = read_lock, .write = write_lock},
	AREA_MEMORY(memory, 256),
	FLAG("ot", special, 0),
	FLAG("ov", protection, 7),
	PROPERTY_DIR("pages"),
	{.name = "pages/page", .type = PROPERTY_BINARY, .life = LIFE_VOLATILE,
	 .access = ACCESS_BOTH, .array = {2, INDEX_NUMBERS, false}, .size = 4,
	 FIELD(eeprom, .at = 0x20, .stride = 0x10)},
	FLAG("psf", special, 7),
	FLAG("uv", protection, 6),
};
/* clang-format on */

const struct family family_31 = {.code = 0x31, .type = "DS2720", PROPERTIES(properties)};
