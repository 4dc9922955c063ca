/* SPDX-License-Identifier: MIT */
/*
 * WS603: a weather station that speaks through the memory of its DS2760. It is asked by writing to
 * that memory, also when it is read: so what it says is hidden. Who only looks at directories does
 * not write to a DS2760 that has no station.
 */
#pragma once

#include "hal/chips/property.h"

/* arg: what is asked for, and from bit 8 on which byte of the answer. */
int ws603_read_byte(struct txn *txn);
int ws603_read_bytes(struct txn *txn);
int ws603_read_wind(struct txn *txn);
/* arg, from bit 16 on: the command. */
int ws603_write_byte(struct txn *txn);
int ws603_write_lights(struct txn *txn);

enum { WS603_PARAMETERS = 0xa0, WS603_DATA, WS603_LIGHTS, WS603_SET_WIND, WS603_SET_DIRECTION };

/* clang-format off */
/* Four ways of the family, from first on. */
#define WS603_WAYS(first) \
	[first] = {.read = ws603_read_byte, .write = ws603_write_byte}, \
	[(first) + 1] = {.read = ws603_read_bytes}, \
	[(first) + 2] = {.read = ws603_read_wind}, \
	[(first) + 3] = {.write = ws603_write_lights}

#define WS603_BYTE(text, access_, arg_, first) \
	PROPERTY(text, UNSIGNED, VOLATILE, access_, .hidden = true, .arg = (arg_), .how = (first))
#define WS603_BYTES(text, life_, arg_, first) \
	PROPERTY(text, BINARY, life_, READ, .size = 5, .hidden = true, .arg = (arg_), \
	         .how = (first) + 1)

/* The rows of the table; words: the area with the temperature of the chip. */
#define WS603_PROPERTIES(first, words) \
	PROPERTY_DIR("WS603"), \
	PROPERTY_DIR("WS603/LED"), \
	PROPERTY("WS603/LED/control", UNSIGNED, STABLE, WRITE, AGGREGATE(4, NUMBERS), \
	         .arg = WS603_LIGHTS << 16, .how = (first) + 3), \
	WS603_BYTE("WS603/LED/model", READ, WS603_PARAMETERS, first), \
	WS603_BYTE("WS603/LED/status", READ, WS603_DATA | 2 << 8, first), \
	PROPERTY_DIR("WS603/calibration"), \
	WS603_BYTE("WS603/calibration/direction", BOTH, \
	           WS603_PARAMETERS | 2 << 8 | WS603_SET_DIRECTION << 16, first), \
	WS603_BYTE("WS603/calibration/wind_speed", BOTH, \
	           WS603_PARAMETERS | 1 << 8 | WS603_SET_WIND << 16, first), \
	WS603_BYTES("WS603/data_string", VOLATILE, WS603_DATA, first), \
	WS603_BYTE("WS603/direction", READ, WS603_DATA | 1 << 8, first), \
	PROPERTY_DIR("WS603/light"), \
	WS603_BYTE("WS603/light/intensity", READ, WS603_DATA | 3 << 8, first), \
	WS603_BYTE("WS603/light/threshold", READ, WS603_PARAMETERS | 3 << 8, first), \
	WS603_BYTES("WS603/param_string", STABLE, WS603_PARAMETERS, first), \
	PROPERTY("WS603/temperature", TEMPERATURE, VOLATILE, READ, \
	         FIELD(words, .at = 0x18, .bytes = 2, .big_endian = true, .is_signed = true, \
	               .shift = 5, .unit = .125), GAUGE_CELSIUS), \
	WS603_BYTE("WS603/volt", READ, WS603_DATA | 4 << 8, first), \
	PROPERTY("WS603/wind_speed", FLOAT, VOLATILE, READ, .hidden = true, \
	         MEASURES(0, HUGE_VAL, 2, "m/s"), .how = (first) + 2)
/* clang-format on */
