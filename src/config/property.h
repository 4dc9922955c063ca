/* SPDX-License-Identifier: MIT */
/* What the tables of the families say of the property that a path names. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define PROPERTY_NAME 64

struct path_property {
	const char *type;            /* of the family, as "DS18B20"; NULL: not known */
	bool there;                  /* true too where nobody can know */
	bool readable, writable;     /* true too where nobody can know */
	bool holds;                  /* what is written reads the same (hal/chips/property.h) */
	uint8_t life;                /* enum property_life; 0: not known */
	bool exact;                  /* a whole number, or on and off; true too likewise */
	char held[PROPERTY_NAME];    /* its name, or of the one that shows what it sets; "": none */
	char nearest[PROPERTY_NAME]; /* not there: what was probably meant, or "" */
};

/*
 * Look up a path. Nobody can know: a path without an id or a property, a family that owsd does not
 * know.
 */
struct path_property property_look(const char *path);
