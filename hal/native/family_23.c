/* SPDX-License-Identifier: MIT */
/* DS2433: 4 kbit of EEPROM (data sheet 2433): rows of 32 bytes, 5 ms to copy one. */
#include "hal/native/memory.h"

static const struct memory memory = {
	.size = 512, .page = 32, .row = 32, .copy = 0x55, .checks = false, .strong = true,
	.copy_ns = 5 * TXN_MS,
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
	MEMORY_WHOLE(512, read_memory, write_memory),
	MEMORY_PAGES(16, 32, read_page, write_page),
};

const struct family family_23 = {.code = 0x23, .type = "DS2433", PROPERTIES(properties)};
