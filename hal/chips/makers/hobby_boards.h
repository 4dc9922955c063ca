/* SPDX-License-Identifier: MIT */
/*
 * What the boards of Hobby Boards have in common, families EE and EF: a command for each value, its
 * bytes without a checksum; one of them says which board it is, and so which properties it has.
 */
#pragma once

#include "hal/chips/family.h"

/* The kinds (device.kind) are the numbers that the boards have themselves. */
enum hobby_kind {
	HOBBY_UNKNOWN,
	HOBBY_UVI,
	HOBBY_MOISTURE,
	HOBBY_LOGGER,
	HOBBY_SNIFFER,
	HOBBY_HUB,
	HOBBY_BAROMETER,
	HOBBY_HUMIDITY,
	HOBBY_MULTITEMP = 9,
	HOBBY_OTHER,
};
struct hobby {
	uint16_t version; /* major, minor; 0: not known */
};

/* What stands first in the lists of a family. */
enum { HOBBY_TYPE = 1, HOBBY_VERSION, AFTER_HOBBY_AREAS };
#define HOBBY_AREAS [HOBBY_TYPE] = &hobby_type, [HOBBY_VERSION] = &hobby_version
extern const struct area hobby_type, hobby_version;
enum { WAY_HOBBY_TEXT = 1, WAY_HOBBY_TYPE, WAY_HOBBY_VERSION, AFTER_HOBBY_WAYS };
#define HOBBY_WAYS \
	[WAY_HOBBY_TEXT] = {.read = hobby_read_text, .write = hobby_write_text}, \
	[WAY_HOBBY_TYPE] = {.read = hobby_read_type}, \
	[WAY_HOBBY_VERSION] = {.read = hobby_read_version}
property_function hobby_read_text, hobby_write_text, hobby_read_type, hobby_read_version;

/* family.identify; also reads the kind again when it is known. */
int hobby_identify(struct txn *txn);
/*
 * A read command that loses one bit on its way is the command that writes the same setting, and the
 * read slots after it are ones. So a setting that is all ones proves nothing: -EIO.
 */
int hobby_saw_setting(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n);

/* Names of the kinds; of those that OWFS has no name for, that of the family. */
#define HOBBY_TYPES(own) \
	{ \
		own, "HB_UVI_METER", "HB_MOISTURE_METER", "HB_MOISTURE_METER_DATALOGGER", \
			"HB_SNIFFER", "HB_HUB", own, own, own, "HB_MULTITEMP", own \
	}
/* Areas: what is read, and a setting. */
#define HOBBY_VALUE(text, bytes_, command) \
	.name = (text), .size = (bytes_), .block = (bytes_), .read = (command)
#define HOBBY_SETTING(text, bytes_, get, put) \
	.name = (text), .size = (bytes_), .block = (bytes_), .read = (get), .row = (bytes_), \
	.write = (put), .saw = hobby_saw_setting
/* Semiconductors: as widely as any of them measures. */
#define HOBBY_CELSIUS MEASURES(-58, 128, 1, DEGREES_C)
