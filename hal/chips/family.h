/* SPDX-License-Identifier: MIT */
/*
 * A chip family is one file that states its areas (area.h) and its properties: name, type, array,
 * access, size and life of the value as OWFS has them, and the field of an area that it is
 * (property.h). What no field can say has functions (txn.h). To add a family: write the file, and
 * name it in families.h.
 *
 * Room hal/chips: the chip families: areas, properties, functions; values as texts. Uses hal/wire.
 */
#ifndef HAL_CHIPS_FAMILY_H
#define HAL_CHIPS_FAMILY_H

#include "hal/chips/property.h"

struct family {
	uint8_t code;
	bool thermometer; /* takes Convert T, has its resolution in the scratchpad */
	bool fixed;       /* ... but its resolution cannot be changed */
	bool alarms;      /* answers the conditional search */
	bool is_virtual;  /* no chip: a table of /statistics and the like */
	const char *type; /* "DS18B20" */
	/* NULL: type. Some families hold several chips. */
	const char *(*type_of)(const struct device *device);
	/*
	 * Which of them? Until that is known, requests may be for properties of any. NULL: it is.
	 */
	bool (*is_known)(const struct device *device);
	/* The chip was away or has restarted: what of device.own is void? NULL: all of it. */
	void (*forget)(struct device *device);
	const struct property *properties; /* sorted by name, the hidden ones too */
	unsigned count;
};

/* What the chip is called. */
const char *family_type(const struct device *device);
/* What was known of the chip is void: it was away or has restarted. */
void family_forget(struct device *device);

extern const struct family family_common;
#define FAMILY(code) extern const struct family family_##code;
#include "hal/chips/families.h"
#undef FAMILY

#define PROPERTIES(table) .properties = (table), .count = sizeof(table) / sizeof((table)[0])

#endif
