/* SPDX-License-Identifier: MIT */
/*
 * TMP1826 and TMP1827 (data sheets SBOSA45, SBOSA15): their EEPROM. The facts are those of the
 * maker's pages of the data sheets; the times (tPROG 21 ms, tREADIDLE 0.56 ms at most) are those
 * that a published driver cites.
 *
 * It is read by blocks of 8 bytes. The maker's pages say that a CRC8 follows each block, published
 * drivers read none. So a block is read alone, until three looks are the same, and what follows it
 * is not looked at. But it is read: a chip that has sent a block fetches the next one, and hears no
 * reset meanwhile (a report in the maker's forum).
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/steady.h"
#include "hal/chips/thermometers/tmp1826_memory.h"

#define READ_EEPROM 0xf0
#define PROGRAM_NS (25 * TXN_MS)
#define READ_IDLE_NS TXN_MS

#define BLOCK 8
#define BEHIND 2 /* bytes that are read after a block: longer than tREADIDLE */

static int tmp1826_memory_load(struct txn *txn, const struct area *area, unsigned at,
                               uint8_t *bytes, unsigned n)
{
	static const uint8_t command = READ_EEPROM;
	const uint8_t where[] = {0, (uint8_t)at};
	uint8_t in[BLOCK + BEHIND];
	int err;

	(void)area;
	if (n != BLOCK || at % BLOCK)
		return -EINVAL;
	err = txn_command(txn, &command, 1);
	if (!err)
		err = txn_write_paused(txn, where, sizeof(where), READ_IDLE_NS);
	if (!err)
		err = txn_read(txn, in, sizeof(in));
	if (err)
		return err;
	memcpy(bytes, in, n);
	return steady(txn, in, n);
}

AREA_NAMED(tmp1826_memory, "memory", .size = 256, .address_bytes = 2, .high_first = true,
           .block = BLOCK, .row = BLOCK, .write = 0x0f, .verify = 0xaa, .copy = 0x55, .key = 0xa5,
           .strong = true, .copy_ns = PROGRAM_NS, .load = tmp1826_memory_load);
