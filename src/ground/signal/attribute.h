/* SPDX-License-Identifier: MIT */
/*
 * The names of section 3.3 of the manual: driver signals and attributes of signals, with their
 * short forms; and the one order in which a name is looked up, the same for every interface.
 */
#pragma once

#include <stdbool.h>

#include "src/public/ows.h"

enum attribute {
	ATTR_VALUE,
	ATTR_DGNRESET,
	ATTR_TRANSACTIONS,
	ATTR_READ_ENABLE,
	ATTR_WRITE_ENABLE,
	ATTR_READ_ONE_SHOT,
	ATTR_WRITE_ONE_SHOT,
	ATTR_ALARM,
	ATTR_PER_FACTOR,
	ATTR_PER_COUNT,
	ATTR_PER_MAX,
	ATTR_PEND_COUNT,
	ATTR_PEND_LAST,
	ATTR_PEND_MAX,
	ATTR_PERIOD,
	ATTR_AGE,
	ATTR_AGE_MAX,
	ATTR_RAW,
	/* of the driver itself (record 0) */
	ATTR_DRIVER_DGNRESET,
	ATTR_DRIVER_TRANSACTIONS,
	ATTR_DRIVER_RECONNECTS,
	ATTR_COUNT,
};

struct attribute_def {
	const char *name;   /* "_ReadEnable" */
	const char *brief;  /* "_RE", NULL if none */
	enum ows_type type; /* of _Value: the signal's own, 0 here */
	bool readable, writable;
	bool driver;
};
extern const struct attribute_def attribute_table[ATTR_COUNT];

/*
 * Look a name up: whole name as signal; after removal of `PREFIX__` as signal; driver signal;
 * longest signal name followed by an attribute. find returns the record of a signal's name (len
 * bytes, not NUL-terminated) or -1. Returns the record (0 for driver signals) and *attribute, or
 * -ENOENT.
 */
typedef int attribute_find(void *ctx, const char *name, size_t len);
int attribute_lookup(const char *prefix, const char *name, attribute_find *find, void *ctx,
                     enum attribute *attribute);

/*
 * What is wrong with the name of a signal, NULL if nothing: a name is 1 to 63 bytes of printable
 * UTF-8 with no blank and none of / " # { }.
 */
#define SIGNAL_NAME_MAX 63
const char *signal_name_fault(const char *name);
