/* SPDX-License-Identifier: MIT */
/* What the tables of the families say of the property that a path names. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define PROPERTY_NAME 64
#define PROPERTY_NEAREST 160

struct path_property {
	const char *type;         /* of the family, as "DS18B20"; NULL: not known */
	bool exists;              /* true too of what the tables do not have */
	bool readable, writable;  /* likewise */
	bool holds;               /* what is written reads the same (hal/chips/property.h) */
	uint8_t life;             /* enum property_life; 0: not known */
	bool exact;               /* a whole number, or on and off; true too likewise */
	char held[PROPERTY_NAME]; /* its name, or of the one that shows what it sets; "": none */
	char nearest[PROPERTY_NEAREST]; /* does not exist: what was probably meant, or "" */
};

/*
 * Look up a path. The tables do not have: a path without an id or a property, a family that owsd
 * does not know.
 */
struct path_property property_look(const char *path);
