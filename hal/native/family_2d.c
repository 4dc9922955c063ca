/* SPDX-License-Identifier: MIT */
/* DS2431: 1024 bits of EEPROM (data sheet 19-4675): rows of 8 bytes, 10 ms to copy one. */
#include "hal/native/memory.h"

static const struct memory memory = {
	.size = 128, .page = 32, .row = 8, .copy = 0x55, .checks = true, .strong = true,
	.copy_ns = 10 * TXN_MS,
};

static int read_memory(struct txn *txn)
{
	return memory_read(txn, &memory);
}

static int write_memory(struct txn *txn)
{
	return memory_write(txn, &memory);
}

static int read_page(struct txn *txn)
{
	return memory_read_page(txn, &memory);
}

static int write_page(struct txn *txn)
{
	return memory_write_page(txn, &memory);
}

static const struct property properties[] = {
	MEMORY_WHOLE(128, read_memory, write_memory),
	MEMORY_PAGES(4, 32, read_page, write_page),
};

const struct family family_2d = {.code = 0x2d, .type = "DS2431", PROPERTIES(properties)};
