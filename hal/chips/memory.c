/* SPDX-License-Identifier: MIT */
/* Memories that are read with F0h and written through a scratchpad, row by row. */
#include <errno.h>
#include <string.h>

#include "hal/chips/memory.h"
#include "hal/wire/crc.h"

#define READ_MEMORY 0xf0
#define WRITE_SCRATCHPAD 0x0f
#define READ_SCRATCHPAD 0xaa
#define ROW_MAX 32
#define BLANK_LOOKS 3 /* more */

/*
 * These memories have no checksum of their own: each chunk is read MEMORY_LOOKS times, and has to
 * be the same. kept holds what was read first.
 */
int memory_look(struct txn *txn, unsigned look, const uint8_t *command, size_t command_n,
                uint8_t *kept, size_t n)
{
	uint8_t again[MEMORY_CHUNK];
	int err = txn_command(txn, command, command_n);

	if (!err)
		err = txn_read(txn, again, n);
	if (err)
		return err;
	if (look == 0)
		memcpy(kept, again, n);
	else if (memcmp(kept, again, n) != 0)
		return -EBADMSG;
	if (look + 1 < MEMORY_LOOKS)
		return TXN_MORE;
	/* So long as nothing but ones is read, perhaps nobody hears: the last look is made again. */
	if (txn->silent && ++txn->blanks <= BLANK_LOOKS) {
		txn->phase--;
		return TXN_MORE;
	}
	txn->blanks = 0;
	return 0;
}

static int read_range(struct txn *txn, unsigned address, unsigned n)
{
	unsigned at = txn->phase / MEMORY_LOOKS * MEMORY_CHUNK, from = address + at;
	unsigned part = n - at < MEMORY_CHUNK ? n - at : MEMORY_CHUNK;
	uint8_t command[] = {READ_MEMORY, (uint8_t)from, (uint8_t)(from >> 8)};
	int err = memory_look(txn, txn->phase++ % MEMORY_LOOKS, command, sizeof(command), txn->mem,
	                      part);

	if (err)
		return err;
	memcpy(txn->data + at, txn->mem, part);
	txn->len = at + part;
	return txn->len < n ? TXN_MORE : 0;
}

static const struct chip_memory *memory_of(const struct txn *txn)
{
	return txn->device->family->memory;
}

int memory_read(struct txn *txn)
{
	return read_range(txn, 0, memory_of(txn)->size);
}

int memory_read_page(struct txn *txn)
{
	const struct chip_memory *memory = memory_of(txn);

	return read_range(txn, (unsigned)txn->element * memory->page, memory->page);
}

static int write_row(struct txn *txn, const struct chip_memory *memory, unsigned address,
                     const uint8_t *row)
{
	uint8_t command[3 + ROW_MAX] = {WRITE_SCRATCHPAD, (uint8_t)address,
	                                (uint8_t)(address >> 8)};
	uint8_t crc[2];
	int err;

	memcpy(command + 3, row, memory->row);
	err = txn_command(txn, command, 3u + memory->row);
	/* The checksum comes when the scratchpad was filled to its end. */
	if (err || !memory->checks)
		return err;
	err = txn_read(txn, crc, sizeof(crc));
	if (err)
		return err;
	uint16_t sum = onewire_crc16(0, command, 3u + memory->row);
	return onewire_crc16_matches(sum, crc) ? 0 : -EBADMSG;
}

/* What the scratchpad holds; the ending offset goes to mem[0]. */
static int verify_row(struct txn *txn, const struct chip_memory *memory, unsigned address,
                      const uint8_t *row)
{
	static const uint8_t command = READ_SCRATCHPAD;
	uint8_t in[3 + ROW_MAX];
	size_t n = 3u + memory->row;
	int err = txn_command(txn, &command, 1);

	if (!err)
		err = memory->checks ? txn_read_crc16(txn, &command, 1, in, n)
		                     : txn_read(txn, in, n);
	if (err)
		return err;
	if (in[0] != (uint8_t)address || in[1] != (uint8_t)(address >> 8) ||
	    memcmp(in + 3, row, memory->row) != 0)
		return -EBADMSG;
	txn->mem[0] = in[2];
	return 0;
}

static int copy_row(struct txn *txn, const struct chip_memory *memory, unsigned address)
{
	uint8_t command[] = {memory->copy, (uint8_t)address, (uint8_t)(address >> 8), txn->mem[0]};

	if (memory->strong)
		return txn_command_strong(txn, command, sizeof(command), memory->copy_ns);
	int err = txn_command(txn, command, sizeof(command));
	return err ? err : txn_wait(txn, memory->copy_ns);
}

/*
 * Row by row: look what is there, put the new bytes in, and write if it differs, for an EEPROM
 * wears out. mem[8..] holds the row.
 */
static int write_range(struct txn *txn, const struct chip_memory *memory, unsigned address,
                       unsigned n)
{
	enum { WRITE = MEMORY_LOOKS, VERIFY, COPY, CHECK, STEPS };
	unsigned row = memory->row, first = address / row * row;
	unsigned here = first + txn->phase / STEPS * row, step = txn->phase % STEPS;
	unsigned from = here < address ? address : here;
	unsigned to = here + row < address + n ? here + row : address + n;
	uint8_t command[] = {READ_MEMORY, (uint8_t)here, (uint8_t)(here >> 8)};
	uint8_t *bytes = txn->mem + 8;
	uint8_t in[ROW_MAX];
	int err = 0;

	if (n == 0)
		return 0;
	switch (step) {
	case WRITE:
		err = write_row(txn, memory, here, bytes);
		break;
	case VERIFY:
		err = verify_row(txn, memory, here, bytes);
		break;
	case COPY:
		err = copy_row(txn, memory, here);
		break;
	case CHECK:
		err = txn_command(txn, command, sizeof(command));
		if (!err)
			err = txn_read(txn, in, row);
		txn->silent = false;
		if (!err && memcmp(in, bytes, row) != 0)
			err = -EIO;
		break;
	default:
		err = memory_look(txn, step, command, sizeof(command), bytes, row);
		txn->silent = false;
	}
	if (err < 0)
		return err;
	if (step == MEMORY_LOOKS - 1 && err == 0) {
		memcpy(in, bytes, row);
		memcpy(bytes + (from - here), txn->data + (from - address), to - from);
		if (memcmp(bytes, in, row) == 0)
			txn->phase += STEPS - MEMORY_LOOKS;
	}
	txn->phase++;
	return to == address + n && txn->phase % STEPS == 0 ? 0 : TXN_MORE;
}

int memory_write(struct txn *txn)
{
	return write_range(txn, memory_of(txn), (unsigned)txn->at, (unsigned)txn->len);
}

int memory_write_page(struct txn *txn)
{
	const struct chip_memory *memory = memory_of(txn);
	unsigned page = (unsigned)txn->element * memory->page;

	return write_range(txn, memory, page + (unsigned)txn->at, (unsigned)txn->len);
}
