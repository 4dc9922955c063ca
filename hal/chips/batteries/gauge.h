/* SPDX-License-Identifier: MIT */
/*
 * What the battery gauges with 256 addresses have in common: areas, and ways that no field has.
 * None of their bytes has a checksum; words come high byte first. The tables are in gauges.c.
 *
 * So what is read is looked at three times, with a recall each, and what is written is read back;
 * of what goes on counting two counts are allowed. Start Charge, Stop Charge and Refresh of a
 * DS2770 show in its status. A bit turned over in the address of a write reaches another byte, at
 * once: nothing shows that.
 */
#pragma once

#include "hal/chips/family.h"

/* Their areas. */
enum {
	MEMORY = 1, /* as it is, the shadow of the EEPROM too; read-only */
	WORDS,      /* the same, two by two */
	BYTES,      /* the same, one by one */
	CHARGE,     /* the accumulated current */
	EEPROM,     /* in blocks of 16 bytes */
	EEPROM4,    /* ... of 4 */
	EEPROM32,   /* ... of 32 */
	PARAMETERS, /* of DS2780 and DS2781: one block of their EEPROM */
	PROTECTION, /* of DS2720 and DS2760: the protection register */
	PINS_OF,    /* ... the same byte to read the pins */
	STATUS,     /* a byte that is written by itself, as those that follow */
	SPECIAL_08,
	SPECIAL_15,
	ALARM,
	TIMER, /* of a DS2770 */
	GAUGE_AREAS
};
extern const struct area *const gauge_areas[GAUGE_AREAS];

enum {
	WAY_LOCK = 1,   /* arg: the EEPROM register */
	WAY_COUPLE,     /* arg: its type, the temperature's address, how fine the voltage is */
	WAY_COUPLE_LOW, /* arg: its type */
	WAY_COUPLE_HIGH,
	WAY_REFUSED,
	WAY_CHARGE, /* of a DS2770 */
	/* of a DS2760 */
	WAY_PAGE,
	WAY_PMOD,
	WAY_SWEN,
	WAY_CURRENTBIAS,
	WAY_VBIAS,
	WAY_WS603_BYTE,
	WAY_WS603_BYTES,
	WAY_WS603_WIND,
	WAY_WS603_LIGHTS,
	GAUGE_WAYS
};
extern const struct property_how gauge_how[GAUGE_WAYS];

/* V across the resistor of one step of a word: of 13 bits, left-aligned, and of 16. */
#define GAUGE_COARSE (15.625e-6 / 8)
#define GAUGE_FINE 1.5625e-6
/* The resistor that some of them have inside, in Ohm. */
#define GAUGE_RESISTOR .025

/* The biases of a DS2760: in the EEPROM, and in its shadow. */
#define GAUGE_BIAS(resistor) .at = 0x33, .is_signed = true, .unit = 15.625e-6 / (resistor)
