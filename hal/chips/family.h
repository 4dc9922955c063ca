/* SPDX-License-Identifier: MIT */
/*
 * A chip family is one file that states its areas (area.h) and its properties: name, type, array,
 * access, size and life of the value as OWFS has them, and the field of an area that it is
 * (property.h). A row of that table holds no pointer: it names its area, and what no field can say
 * (functions, txn.h), by its number in the family's lists. To add a family: write the file in the
 * folder of its kind (thermometers, memories and mere ids, switches and converters, batteries,
 * loggers and clocks, bridges, makers other than those of the standard chips), and name it in
 * families.h.
 *
 * Room hal/chips: the chip families: areas, properties, functions; values as texts.
 */
#pragma once

#include "hal/chips/property.h"

/* What shows that it was this chip that answered, now. */
enum family_proof {
	PROOF_UNSAID,   /* then nothing but ones, or zeros, is no answer */
	PROOF_CHECKSUM, /* the same: each answer has a checksum that ones and zeros do not pass */
	/*
	 * Some answer has none. If it is nothing but ones, or zeros, as the idle or the short wire
	 * gives them, the bus reads it again between two searches that find the chip by its id.
	 */
	PROOF_PRESENCE,
	PROOF_NONE_READ, /* nothing is read of it but its id: a search shows that it is there */
};

/* What owserver's directories say of the families in them. */
enum {
	FLAG_RESUME = 0x0001,
	FLAG_ALARM = 0x0002,
	FLAG_OVERDRIVE = 0x0004,
	FLAG_CHAIN = 0x2000,
	FLAG_VOLT = 0x4000,
	FLAG_TEMPERATURE = 0x8000,
};

/* What most people want of a device: a property, and a word for the name of its signal. */
struct family_scan {
	/*
	 * "temperature12", "temperature". Of an array, "volts" means each element, "PIO.BYTE" all
	 * at once. Where the chips of a family differ, "EDS0068/light" is of those that have that
	 * directory.
	 */
	const char *name, *word;
};
#define FAMILY_SCANS 20 /* properties of one chip */

struct family {
	uint8_t code;
	uint8_t proof;    /* enum family_proof */
	bool thermometer; /* takes Convert T, has its resolution in the scratchpad */
	bool fixed;       /* ... but its resolution cannot be changed */
	bool alarms;      /* answers the conditional search */
	bool latches;     /* ... and a property tells whether it did */
	bool is_virtual;  /* no chip: a table of /statistics and the like */
	bool several;     /* chips have this code: device.kind says which of them it is */
	uint16_t flags;   /* FLAG_ */
	const char *type; /* "DS18B20", the usual chip of this code */
	const struct family_scan *scan; /* then one without a name; NULL: none */
	/*
	 * What each kind is called; NULL: all as `type`. [0] NULL: a request for `type` asks the
	 * chip first.
	 */
	const char *const *types;
	const char *model; /* the property that says which chip it is; NULL: type says it */
	/*
	 * Sets device.kind, before any property of the family (those that every device has are
	 * none) is read or written, and before a list of its properties is made: 0 it is set,
	 * TXN_MORE or an error. While the kind is 0, requests may be for properties of any kind,
	 * and a list has what all of them have.
	 */
	int (*identify)(struct txn *txn);
	/*
	 * The same for a list alone: the functions of the properties see to the kind themselves,
	 * because the readings themselves show it.
	 */
	int (*tell)(struct txn *txn);
	/*
	 * KIND() of those that a disturbed wire may have made up. They are told anew at the first
	 * request that comes FAMILY_DOUBT_NS later.
	 */
	uint32_t doubted;
	/*
	 * Of a thermometer: which chip it is by a scratchpad after a conversion; exact: of 12 bits
	 * (family_28.c). NULL: a scratchpad shows nothing of that.
	 */
	const char *(*name)(const uint8_t rom[8], const uint8_t scratchpad[9], bool exact);
	uint32_t plain; /* KIND() of those that have the properties whose .kinds is 0; 0: all */
	/* The chip was away or has restarted: what of device.own is void? NULL: all of it. */
	void (*forget)(struct device *device);
	const void *
		facts; /* for the functions of its properties: what tells these chips from others */
	const struct property *properties; /* sorted by name, the hidden ones too */
	const struct area *const *areas;   /* what .area of a field means; [0] is none */
	const struct property_how *how;    /* ... and .how of a property */
	uint16_t count;
	uint8_t area_count, how_count;
};

#define FAMILY_DOUBT_NS INT64_C(1000000000)

/* What the chip is called; NULL: it has not said that yet. */
const char *family_type(const struct device *device);
/*
 * Which chip it is, by its behaviour where its family code does not decide that; a text that lives
 * as long as the program. NULL: not known, or not yet. Asks nothing of the chip.
 */
const char *family_identity(const struct device *device);
/* What was known of the chip is void: it was away or has restarted. */
void family_forget(struct device *device);
/* Is its kind one of family.doubted? */
bool family_doubts(const struct device *device);
/* Would a list of its properties not show which chip it is, and can that be asked? */
bool family_untold(const struct device *device);
/* Is the property one that this chip of its family has? Not known which: that all of them have. */
bool family_has(const struct device *device, const struct property *property);

extern const struct family family_common;
#define FAMILY(code) extern const struct family family_##code;
#include "hal/chips/families.h"
#undef FAMILY

/* A family, its lists among what follows: CHIP_FAMILY(01, "DS2401", NONE_READ, SCAN(...)); */
#define CHIP_FAMILY(code_, part, proof_, ...) \
	const struct family family_##code_ = { \
		.code = 0x##code_, .type = (part), .proof = PROOF_##proof_, __VA_ARGS__}
#define SCAN(...) \
	.scan = (const struct family_scan[]) \
	{ \
		__VA_ARGS__, \
		{ \
			NULL, NULL \
		} \
	}
#define PROPERTIES(table) .properties = (table), .count = sizeof(table) / sizeof((table)[0])
#define AREAS(list) .areas = (list), .area_count = sizeof(list) / sizeof((list)[0])
#define HOW(list) .how = (list), .how_count = sizeof(list) / sizeof((list)[0])
/*
 * The ways of a family in one list, #define WAYS(X) X(CLOCK, .read = read_clock) ..., of which
 * enum { WAY_NONE, WAYS(WAY_ENUM) } and how[] = {WAYS(WAY_HOW)} are made.
 */
#define WAY_ENUM(name, ...) WAY_##name,
#define WAY_HOW(name, ...) [WAY_##name] = {__VA_ARGS__},

/*
 * The hidden property "identity" of families whose code does not decide which chip it is: the
 * chip's name by its behaviour, with what is odd about it ("DS18B20 clone, family B1"), or
 * "unknown". The function of the way ends with property_text().
 */
#define IDENTITY_ROW(way, ...) \
	PROPERTY("identity", ASCII, STABLE, READ, .size = 48, .hidden = true, .how = (way), \
	         __VA_ARGS__)
