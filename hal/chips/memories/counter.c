/* SPDX-License-Identifier: MIT */
/* The counter that belongs to a page of a memory. */
#include <errno.h>
#include <string.h>

#include "hal/chips/field.h"
#include "hal/chips/memories/counter.h"

#define READ_COUNTER 0xa5

/* From the page's last byte on: that byte, 32 bits of counter, 32 others, and the CRC16. */
static int counter_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                        unsigned n)
{
	unsigned address = at / area->block * 32 + 31;
	uint8_t command[] = {READ_COUNTER, (uint8_t)address, (uint8_t)(address >> 8)}, in[9];
	int err = txn_ask_crc16(txn, command, sizeof(command), in, sizeof(in));

	if (!err)
		memcpy(bytes, in + 1, n);
	return err;
}

AREA_NAMED(counter_area, "counters", .size = 64, .block = 4, .load = counter_load);

int counter_read_page(struct txn *txn)
{
	return txn->element < txn->property->arg ? -ENOENT : field_read(txn);
}
