/* SPDX-License-Identifier: MIT */
/* The EPROM of DS2505 and DS2506: reading it with its checksums. */
#include <errno.h>
#include <string.h>

#include "hal/chips/memories/eprom.h"
#include "hal/wire/crc.h"

#define EXTENDED_READ_MEMORY 0xa5
#define READ_STATUS 0xaa
#define REDIRECTIONS 0x100 /* of the status memory: a byte for each page */

/* A redirection byte with a checksum, the page with another one; all in one read. */
int eprom_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n)
{
	const uint8_t command[] = {EXTENDED_READ_MEMORY, (uint8_t)at, (uint8_t)(at >> 8)};
	uint8_t in[3 + AREA_UNIT + 2];
	int err = txn_ask(txn, command, sizeof(command), in, 3 + n + 2);

	(void)area;
	if (err)
		return err;
	if (!onewire_crc16_matches(onewire_crc16(onewire_crc16(0, command, 3), in, 1), in + 1) ||
	    !onewire_crc16_matches(onewire_crc16(0, in + 3, n), in + 3 + n))
		return txn_checked(txn, false);
	memcpy(bytes, in + 3, n);
	return 0;
}

/*
 * Of the pages that owserver counts three begin at 00h, 20h and 40h; the others are the redirection
 * bytes. The chip sends a checksum after each eight bytes.
 */
int eprom_load_status(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                      unsigned n)
{
	unsigned size = area->size / EPROM_STATUS_PAGES, page = at / size;
	unsigned where = (page < 3 ? page * 0x20 : REDIRECTIONS + (page - 3) * size) + at % size;
	const uint8_t command[] = {READ_STATUS, (uint8_t)where, (uint8_t)(where >> 8)};
	return txn_ask_crc16(txn, command, sizeof(command), bytes, n);
}
