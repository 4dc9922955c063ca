/* SPDX-License-Identifier: MIT */
/*
 * Which register is what. Each signal has a place, a number from 1 that never changes, and its
 * record of 16 registers begins at 16 times that number; place 0 is the header. After the records
 * the same values stand again, each kind in a row: for programs that read many at once. Pure.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define LAYOUT_PLACES 2048 /* with that of the header */
#define LAYOUT_RECORD 16   /* registers */
#define LAYOUT_FIELD_MOST 4

enum layout_field {
	LAYOUT_DOUBLE, /* float64 */
	LAYOUT_FLOAT,  /* float32 */
	LAYOUT_LONG,   /* int32, the value with so many decimals */
	LAYOUT_SHORT,  /* int16, likewise */
	LAYOUT_QUALITY,
	LAYOUT_AGE, /* uint32, tenths of a second; all ones: never measured, or more */
	LAYOUT_ALARM,
	LAYOUT_COUNT, /* of updates, modulo 65536 */
	LAYOUT_DECIMALS,
	LAYOUT_FLAGS,
	LAYOUT_HEADER,
};

/* Bits of LAYOUT_ALARM; its upper byte has the kind of the limit alarm, enum ows_alarm_kind. */
#define LAYOUT_ALARM_LIMIT 0x01
#define LAYOUT_ALARM_UNACKNOWLEDGED 0x02
#define LAYOUT_ALARM_DEVICE 0x04
#define LAYOUT_ALARM_SHELVED 0x08
/* Bits of LAYOUT_FLAGS; from LAYOUT_FLAG_HEALTH on what the signal says of its device. */
#define LAYOUT_FLAG_OUTPUT 0x01
#define LAYOUT_FLAG_SIMULATED 0x02
#define LAYOUT_FLAG_HEALTH 8 /* enum device_health */

/* What is served of a signal at one moment. */
struct layout_row {
	bool good;
	double number; /* counts if good */
	uint8_t quality;
	int64_t age_ns; /* below 0: never measured */
	uint16_t alarm, count, flags, decimals;
};

/* The registers of the header. */
enum layout_head {
	LAYOUT_MAGIC,       /* uint32 0x4f575344, "OWSD" where the high word comes first */
	LAYOUT_VERSION = 2, /* of this layout */
	LAYOUT_LIVE,        /* 1: owsd is there; 0: no value is good */
	LAYOUT_HEART,       /* changes while owsd works, ten times a second at most */
	LAYOUT_GENERATION,  /* of owsd's start or reload */
	LAYOUT_LAST,        /* the highest place that a signal has or had */
	LAYOUT_SIGNALS,     /* how many places have a signal */
	LAYOUT_CHANGED,     /* uint32, UTC of the last change of a value or quality; 0: none */
	LAYOUT_TIME = 10,   /* uint32, UTC now */
	LAYOUT_BEAT = 12,   /* what a client writes here is its beat; reads as 0 */
};
#define LAYOUT_MAGIC_NUMBER 0x4f575344u

struct layout_place {
	enum layout_field field;
	unsigned place, part; /* part: which register of the field, as it is addressed */
};

/* False: no place has that register. */
bool layout_find(unsigned address, struct layout_place *at);
/* How many registers it takes. */
unsigned layout_width(enum layout_field field);
/* Is it made of the number, so that it has nothing to show of a value that is not good? */
bool layout_is_value(enum layout_field field);
/* Where the field of that place begins in its record. */
unsigned layout_in_record(enum layout_field field, unsigned place);
/* Where the field of that place begins in the rows of its kind; 0: it has none. */
unsigned layout_in_row(enum layout_field field, unsigned place);

/* A register of a row. little: the low word of a number comes first. */
uint16_t layout_register(const struct layout_row *row, const struct layout_place *at, bool little);
/*
 * The number that registers of a field of a value mean, the way back. False: none, as those of a
 * value that is not good.
 */
bool layout_number(const uint16_t *registers, enum layout_field field, unsigned decimals,
                   bool little, double *number);
/* Put a number of 32 bits where two registers stand. */
void layout_put_32(uint16_t *registers, uint32_t number, bool little);
