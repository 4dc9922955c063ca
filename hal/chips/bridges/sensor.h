/* SPDX-License-Identifier: MIT */
/*
 * The table of the sensors behind bridges: how each kind is measured (write, wait, read, check,
 * formula), and which of them are behind which bridge. docs/bridges.md has the language.
 *
 * All is allocated when the table is read. Each bridge becomes a family of its own whose properties
 * are the values of its sensors.
 */
#pragma once

#include "hal/chips/bridges/formula.h"
#include "hal/chips/family.h"

#define SENSOR_BYTES 64     /* that one measurement reads */
#define SENSOR_AT_ONCE 32   /* bytes of one reading; of one writing */
#define SENSOR_EXCHANGED 40 /* of one that writes and reads */
#define SENSOR_NAMES 16     /* formulas with a name, in one kind */

enum sensor_step_kind {
	SENSOR_WRITE,
	SENSOR_EXCHANGE,
	SENSOR_READ,
	SENSOR_WAIT,
	SENSOR_CRC8,
	SENSOR_SAME,
	SENSOR_LET
};

struct sensor_step {
	uint8_t kind;
	uint8_t at, n; /* bytes that are read; of CRC8, those before the checksum */
	uint8_t polynomial, start;
	unsigned first, count; /* bytes that are written: formulas of the table */
	struct formula a, b;   /* SAME: both; LET: a */
	uint8_t name;
	int64_t wait_ns;
};

struct sensor_value {
	char name[FORMULA_NAME];
	uint8_t type; /* enum property_type */
	bool ranged, writable;
	double low, high;
	struct formula formula;
	unsigned first, count; /* what is written to set it */
};

struct sensor_kind {
	char name[FORMULA_NAME];
	unsigned line; /* where it begins */
	unsigned first_step, steps, first_value, values;
	uint8_t bytes; /* that it reads */
	char names[SENSOR_NAMES][FORMULA_NAME];
	unsigned name_count;
};

/* A sensor behind a bridge. */
struct sensor_chip {
	unsigned kind;               /* which of the table's */
	uint8_t address;             /* 7 bits */
	uint8_t bytes[SENSOR_BYTES]; /* as they are read, by one request at a time */
	double names[SENSOR_NAMES];
};

struct sensor_bridge {
	struct family family; /* what its device has in place of the code's */
	uint8_t rom[8];
	struct property *properties;
	struct sensor_chip *chips;
	unsigned count;
	struct sensor_table *table;
};

struct sensor_table {
	struct formula_pool pool;
	struct formula *bytes; /* what is written */
	struct sensor_step *steps;
	struct sensor_value *values;
	struct sensor_kind *kinds;
	struct sensor_bridge *bridges;
	unsigned byte_count, step_count, value_count, kind_count, bridge_count;
};
