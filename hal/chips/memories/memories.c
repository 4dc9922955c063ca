/* SPDX-License-Identifier: MIT */
/*
 * Memories that differ in their size and in how they are copied, and mere ids, by their data sheets
 * ("Memory function commands"):
 * - DS1992, DS1993, DS1995, DS1996: RAM with a battery
 * - DS2431 (19-4675), DS2433, DS28EC20 (19-6067): EEPROM
 * - DS2430A (19-5235): 32 bytes of EEPROM, and 8 that can be written once
 * - DS2502 (19-5076), DS1982U: EPROM, programmed with 12 V, which no adapter here gives: no row
 * - DS2401, DS1990A, DS1420 (19-4890): an id and nothing else
 *
 * Where a reading has no CRC8 (DS2502) or CRC16 (DS28EC20) there are three looks, and three to six
 * more between two searches for the chip if all is ones or zeros. A scratchpad is read back before
 * its copy, and the memory after it.
 */
#include "hal/chips/family.h"

enum { MEMORY = 1, APPLICATION, STATUS };
#define PAGE 32
#define SCRATCHPAD(row_) \
	.address_bytes = 2, .row = (row_), .write = 0x0f, .verify = 0xaa, .copy = 0x55
#define EEPROM_COPY(ms) .strong = true, .copy_ns = (ms)*TXN_MS
#define PRESENT SCAN({"present", "present"})

/* clang-format off */
#define MEMORY_ROWS(pages) \
	AREA_MEMORY(MEMORY, (pages)*PAGE), PROPERTY_DIR("pages"), AREA_PAGES(MEMORY, pages, PAGE)
#define MEMORY_FAMILY(code_, part, proof_, pages, more, ...) \
	static const struct area *const areas_##code_[] = { \
		[MEMORY] = AREA(.name = "memory", .size = (pages)*PAGE, __VA_ARGS__)}; \
	static const struct property properties_##code_[] = {MEMORY_ROWS(pages)}; \
	CHIP_FAMILY(code_, part, proof_, more, AREAS(areas_##code_), PROPERTIES(properties_##code_))

MEMORY_FAMILY(06, "DS1993", PRESENCE, 16, .flags = 0, SCRATCHPAD(32), .read = 0xf0);
MEMORY_FAMILY(08, "DS1992", PRESENCE, 4, .flags = 0, SCRATCHPAD(32), .read = 0xf0);
MEMORY_FAMILY(0a, "DS1995", PRESENCE, 64, .flags = FLAG_OVERDRIVE, SCRATCHPAD(32), .read = 0xf0);
MEMORY_FAMILY(0c, "DS1996", PRESENCE, 256, .flags = FLAG_OVERDRIVE, SCRATCHPAD(32), .read = 0xf0);
#define OVERDRIVEN(flags_) .flags = FLAG_OVERDRIVE | (flags_), PRESENT
MEMORY_FAMILY(23, "DS2433", PRESENCE, 16, OVERDRIVEN(0), SCRATCHPAD(32), .read = 0xf0,
              EEPROM_COPY(5));
MEMORY_FAMILY(2d, "DS2431", PRESENCE, 4, OVERDRIVEN(FLAG_RESUME), SCRATCHPAD(8), .read = 0xf0,
              .write_crc16 = true, EEPROM_COPY(10));
MEMORY_FAMILY(43, "DS28EC20", CHECKSUM, 80, OVERDRIVEN(FLAG_RESUME), SCRATCHPAD(32), .read = 0xa5,
              .block = PAGE, .check = AREA_CRC16, .write_crc16 = true, EEPROM_COPY(10));
MEMORY_FAMILY(09, "DS2502", PRESENCE, 4, PRESENT, .address_bytes = 2, .read = 0xc3, .block = PAGE,
              .check = AREA_CRC8_PAGES);

/*
 * DS1982U, DS2502-E48: one whose first bytes the factory has written (data sheet "48-Bit Node
 * Address Chip"): a project code, and an Ethernet or FireWire address.
 */
#define PART(text, at_, bytes_) \
	PROPERTY(text, BINARY, STABLE, READ, .size = (bytes_), FIELD(MEMORY, .at = (at_)))
static const struct property ds1982u[] = {
	PART("mac_e", 4, 6),
	PART("mac_fw", 4, 8),
	MEMORY_ROWS(4),
	PART("project", 0, 4),
};
CHIP_FAMILY(89, "DS1982U", PRESENCE, AREAS(areas_09), PROPERTIES(ds1982u));

#define DS2430A(bytes_) \
	.size = (bytes_), .address_bytes = 1, .row = (bytes_), .key = 0xa5, EEPROM_COPY(10)
static const struct area *const ds2430a_areas[] = {
	[MEMORY] = AREA(.name = "memory", DS2430A(32), .read = 0xf0, .write = 0x0f, .verify = 0xaa,
	                .copy = 0x55),
	/* AAh has the scratchpad of the memory, not that of the register */
	[APPLICATION] = AREA(.name = "application", DS2430A(8), .read = 0xc3, .write = 0x99,
	                     .verify = 0xc3, .copy = 0x5a),
	[STATUS] = AREA(.name = "status", .size = 1, .address_bytes = 1, .read = 0x66),
};
static const struct property ds2430a[] = {
	PROPERTY("application", BINARY, STABLE, BOTH, .size = 8, FIELD(APPLICATION)),
	AREA_MEMORY(MEMORY, 32),
	PROPERTY("status", UNSIGNED, STABLE, READ, FIELD(STATUS)),
};
CHIP_FAMILY(14, "DS2430A", PRESENCE, PRESENT, AREAS(ds2430a_areas), PROPERTIES(ds2430a));

CHIP_FAMILY(01, "DS2401", NONE_READ, PRESENT);
CHIP_FAMILY(81, "DS1420", NONE_READ, .flags = 0);
/* clang-format on */
