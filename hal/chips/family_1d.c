/* SPDX-License-Identifier: MIT */
/* DS2423 (data sheet 19-5140): 4 kbit of RAM, and counters on its last four pages. */
#include <errno.h>
#include <string.h>

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
static int load_counter(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                        unsigned n)
{
	unsigned address = at / area->block * 32 + 31;
	uint8_t command[] = {READ_COUNTER, (uint8_t)address, (uint8_t)(address >> 8)}, in[9];
	int err = txn_command(txn, command, sizeof(command));

	if (!err)
		err = txn_read_crc16(txn, command, sizeof(command), in, sizeof(in));
	if (!err)
		memcpy(bytes, in + 1, n);
	return err;
}

/* Four bytes for each page. */
static const struct area counters = {
	.name = "counters", .size = 64, .block = 4, .load = load_counter};

static int read_minimum(struct txn *txn)
{
	unsigned page = EXTERNAL_A + txn->phase;
	uint8_t in[4];
	int err = area_read(txn, &counters, page * 4, in, sizeof(in));

	if (err)
		return err;
	uint32_t count = in[0] | in[1] << 8 | in[2] << 16 | (uint32_t)in[3] << 24;
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
	PROPERTY(text, UNSIGNED, VOLATILE, READ, ELEMENTS(n, index_), \
	         FIELD(counters, .at = 4 * (page), .stride = 4, .bytes = 4), __VA_ARGS__)

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
