/* SPDX-License-Identifier: MIT */
/*
 * DS2505, DS2506 and, with contents from the factory, DS1985U and DS1986U: 16 and 64 kbit of EPROM
 * (data sheets, "16kbit Add-Only Memory", "64kbit Add-Only Memory"): pages of 32 bytes, and status
 * bytes in eleven pages. It is programmed with pulses of 12 V, which no adapter here gives: the
 * areas have no row.
 *
 * Extended Read Memory and Read Status have a CRC16.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/wire/crc.h"

#define EXTENDED_READ_MEMORY 0xa5
#define READ_STATUS 0xaa
#define REDIRECTIONS 0x100 /* of the status memory: a byte for each page */
/* One bit for each page of the memory in each of three status pages, and one byte in eight. */
#define STATUS_PAGES 11

/* A redirection byte with a checksum, the page with another one; all in one read. */
static int eprom_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                      unsigned n)
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
static int eprom_load_status(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                             unsigned n)
{
	unsigned size = area->size / STATUS_PAGES, page = at / size;
	unsigned where = (page < 3 ? page * 0x20 : REDIRECTIONS + (page - 3) * size) + at % size;
	const uint8_t command[] = {READ_STATUS, (uint8_t)where, (uint8_t)(where >> 8)};
	return txn_ask_crc16(txn, command, sizeof(command), bytes, n);
}

enum { MEMORY = 1, STATUS };
#define EPROM(part, pages) \
	static const struct area *const part##_areas[] = { \
		[MEMORY] = AREA(.name = "memory", .size = 32 * (pages), .block = 32, \
	                        .load = eprom_load), \
		[STATUS] = AREA(.name = "status", .size = STATUS_PAGES * (pages) / 8, .block = 8, \
	                        .load = eprom_load_status)}; \
	static const struct property part##_properties[] = { \
		AREA_MEMORY(MEMORY, 32 * (pages)), \
		PROPERTY_DIR("pages"), \
		AREA_PAGES(MEMORY, pages, 32), \
		PROPERTY_DIR("status"), \
		PROPERTY("status/page", BINARY, STABLE, BOTH, ELEMENTS(STATUS_PAGES, NUMBERS), \
	                 .size = (pages) / 8, FIELD(STATUS)), \
	}

EPROM(ds2505, 64);
EPROM(ds2506, 256);
#define LISTS(part) AREAS(part##_areas), PROPERTIES(part##_properties)
CHIP_FAMILY(0b, "DS2505", CHECKSUM, LISTS(ds2505));
CHIP_FAMILY(8b, "DS1985U", CHECKSUM, LISTS(ds2505));
CHIP_FAMILY(0f, "DS2506", CHECKSUM, .flags = FLAG_OVERDRIVE, LISTS(ds2506));
CHIP_FAMILY(8f, "DS1986U", CHECKSUM, .flags = FLAG_OVERDRIVE, LISTS(ds2506));
