/* SPDX-License-Identifier: MIT */
/*
 * Memories of 1-Wire chips that are read with F0h and written through a scratchpad (0Fh, AAh), a
 * page or a part of it per call.
 */
#ifndef HAL_CHIPS_MEMORY_H
#define HAL_CHIPS_MEMORY_H

#include "hal/chips/family.h"

struct chip_memory {
	uint16_t size; /* bytes */
	uint8_t page;  /* of the property */
	uint8_t row;   /* bytes of the scratchpad */
	uint8_t copy;  /* the command that copies it */
	bool checks;   /* CRC16 behind writing and reading the scratchpad */
	bool strong;   /* the copy needs the strong pull-up */
	int64_t copy_ns;
};

/*
 * Bytes without a checksum are read so many times, and have to be the same: noise that turns over
 * one bit in a thousand would get past two looks at a page once in 4,000.
 */
#define MEMORY_LOOKS 3
#define MEMORY_CHUNK 32
/*
 * Look number look, from 0: TXN_MORE, and 0 behind the last. kept: n bytes from call to call. The
 * caller adds 1 to txn->phase for each look.
 */
int memory_look(struct txn *txn, unsigned look, const uint8_t *command, size_t command_n,
                uint8_t *kept, size_t n);

/*
 * The whole memory of the device's family, and page txn->element of it. Write: txn->len bytes from
 * txn->at on.
 */
int memory_read(struct txn *txn);
int memory_read_page(struct txn *txn);
int memory_write(struct txn *txn);
int memory_write_page(struct txn *txn);

/* clang-format off */
#define MEMORY_WHOLE(bytes, writes)                                                       \
	{.name = "memory", .type = PROPERTY_BINARY, .life = LIFE_VOLATILE,                  \
	 .access = ACCESS_BOTH, .size = (bytes), .read = memory_read, .write = (writes)}
#define MEMORY_PAGES(pages, bytes, writes)                                                \
	PROPERTY_DIR("pages"),                                                              \
	{.name = "pages/page", .type = PROPERTY_BINARY, .life = LIFE_VOLATILE,              \
	 .access = ACCESS_BOTH, .array = {(pages), INDEX_NUMBERS, false}, .size = (bytes),  \
	 .read = memory_read_page, .write = (writes)}
/* clang-format on */

#endif
