/* SPDX-License-Identifier: MIT */
/*
 * DS2502: 1 kbit of EPROM (data sheet 19-5076), read by pages that have a CRC8 each. It is
 * programmed with pulses of 12 V, which no adapter here gives: the area has no row.
 * DS1982U, DS2502-E48: one whose first bytes the factory has written (data sheet "48-Bit Node
 * Address Chip"): a project code, and an Ethernet or FireWire address.
 */
#include "hal/chips/family.h"

static AREA_NAMED(memory, "memory", .size = 128, .address_bytes = 2, .read = 0xc3, .block = 32,
                  .check = AREA_CRC8_PAGES);

enum { MEMORY = 1 };
static const struct area *const areas[] = {[MEMORY] = &memory};

static const struct property properties[] = {
	AREA_MEMORY(MEMORY, 128),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 4, 32),
};

CHIP_FAMILY(09, "DS2502", PRESENCE, SCAN({"present", "present"}), AREAS(areas),
            PROPERTIES(properties));

#define PART(text, at_, bytes_) \
	PROPERTY(text, BINARY, STABLE, READ, .size = (bytes_), FIELD(MEMORY, .at = (at_)))

static const struct property written_properties[] = {
	PART("mac_e", 4, 6),   PART("mac_fw", 4, 8),      AREA_MEMORY(MEMORY, 128),
	PROPERTY_DIR("pages"), AREA_PAGES(MEMORY, 4, 32), PART("project", 0, 4),
};

CHIP_FAMILY(89, "DS1982U", PRESENCE, AREAS(areas), PROPERTIES(written_properties));
