/* SPDX-License-Identifier: MIT */
/* DS2423 (data sheet 19-5140): 4 kbit of RAM, and counters on its last four pages. */
#include <errno.h>

#include "hal/chips/family.h"

#define READ_COUNTER 0xa5
#define EXTERNAL_A 14

static const struct area memory = {
	.name = "memory",
	.size = 512,
	.address_bytes = 2,
	.read = 0xf0,
	.row = 32,
	.write = 0x0f,
	.verify = 0xaa,
	.copy = 0x5a,
	.copy_ns = TXN_MS,
};

/* From the page's last byte on: that byte, 32 bits of counter, 32 of zero, and the CRC16. */
static int counter(struct txn *txn, unsigned page, uint32_t *count)
{
	unsigned address = page * 32 + 31;
	uint8_t command[] = {READ_COUNTER, (uint8_t)address, (uint8_t)(address >> 8)}, in[9];
	int err = txn_command(txn, command, sizeof(command));

	if (!err)
		err = txn_read_crc16(txn, command, sizeof(command), in, sizeof(in));
	if (!err)
		*count = in[1] | in[2] << 8 | in[3] << 16 | (uint32_t)in[4] << 24;
	return err;
}

static int read_counter(struct txn *txn)
{
	uint32_t count = 0;
	int err = counter(txn, (unsigned)(txn->property->arg + txn->element), &count);

	txn->number[0] = count;
	return err;
}

static int read_minimum(struct txn *txn)
{
	uint32_t count = 0;
	int err = counter(txn, EXTERNAL_A + txn->phase, &count);

	if (err)
		return err;
	if (txn->phase++ == 0) {
		txn->number[0] = count;
		return TXN_MORE;
	}
	txn->number[0] = txn->number[0] < count ? txn->number[0] : count;
	return 0;
}

/* The counters cannot be set. */
static int write_minimum(struct txn *txn)
{
	(void)txn;
	return -EINVAL;
}

#define COUNTERS(text, n, index_, page, ...) \
	PROPERTY(text, UNSIGNED, VOLATILE, READ, ELEMENTS(n, index_), .arg = (page), \
	         .read = read_counter, __VA_ARGS__)

static const struct property properties[] = {
	COUNTERS("counter", 2, LETTERS, EXTERNAL_A, .hidden = false),
	COUNTERS("counters", 2, LETTERS, EXTERNAL_A, .hidden = true),
	AREA_MEMORY(memory, 512),
	PROPERTY("mincount", UNSIGNED, VOLATILE, BOTH, .read = read_minimum,
                 .write = write_minimum),
	PROPERTY_DIR("pages"),
	COUNTERS("pages/count", 16, NUMBERS, 0, .hidden = false),
	AREA_PAGES(memory, 16, 32),
};

const struct family family_1d = {.code = 0x1d, .type = "DS2423", PROPERTIES(properties)};
