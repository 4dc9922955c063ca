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
	uint8_t alarm;            /* enum property_alarm; 0: nothing, or not known */
	bool exact;               /* a whole number, or on and off; true too likewise */
	bool whole;               /* so by the tables */
	bool text;                /* a text, or a list; false too of what the tables do not have */
	char held[PROPERTY_NAME]; /* its name, or of the one that shows what it sets; "": none */
	char nearest[PROPERTY_NEAREST]; /* does not exist: what was probably meant, or "" */
};

/*
 * Look up a path. The tables do not have: a path without an id or a property, a family that owsd
 * does not know.
 */
struct path_property property_look(const char *path);
/*
 * The properties of the device in path that have one of these bits of enum property_alarm, the one
 * that is most like the path's as text: "latch.BYTE, or latch.0 to latch.7". False: the tables name
 * none.
 */
bool property_of_alarm(const char *path, uint8_t alarm, char text[PROPERTY_NEAREST]);
/*
 * Can the value be written to the property at path? False: *why is the reason, which follows the
 * property's name: " has 9 digits". True too of what the tables do not have.
 */
bool property_takes(const char *path, const char *value, char why[PROPERTY_NEAREST]);
