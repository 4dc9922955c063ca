/* SPDX-License-Identifier: MIT */
/* The tables of addresses, and how a number becomes registers. */
#include <math.h>
#include <string.h>

#include "src/faces/modbus/layout.h"

#define AGE_NS 100000000
#define BAD_SHORT 0x8000u
#define BAD_LONG 0x80000000u
#define BAD_FLOAT 0x7fc00000u
#define BAD_DOUBLE 0x7ff8000000000000u

/* A record, in its order. */
static const struct {
	enum layout_field field;
	unsigned width;
} record[] = {
	{LAYOUT_DOUBLE, 4},   {LAYOUT_FLOAT, 2}, {LAYOUT_LONG, 2},  {LAYOUT_SHORT, 1},
	{LAYOUT_QUALITY, 1},  {LAYOUT_AGE, 2},   {LAYOUT_ALARM, 1}, {LAYOUT_COUNT, 1},
	{LAYOUT_DECIMALS, 1}, {LAYOUT_FLAGS, 1},
};
#define FIELDS (sizeof(record) / sizeof(record[0]))

/* The rows of one kind: the field of a place is at base + width * place. */
static const struct {
	enum layout_field field;
	unsigned base;
} rows[] = {
	{LAYOUT_SHORT, 40000}, {LAYOUT_QUALITY, 43000}, {LAYOUT_FLOAT, 46000},
	{LAYOUT_LONG, 51000},  {LAYOUT_DOUBLE, 56000},
};
#define ROWS (sizeof(rows) / sizeof(rows[0]))

unsigned layout_width(enum layout_field field)
{
	for (size_t i = 0; i < FIELDS; i++)
		if (record[i].field == field)
			return record[i].width;
	return 1;
}

bool layout_is_value(enum layout_field field)
{
	return field <= LAYOUT_SHORT;
}

unsigned layout_in_record(enum layout_field field, unsigned place)
{
	unsigned at = place * LAYOUT_RECORD;

	for (size_t i = 0; i < FIELDS && record[i].field != field; i++)
		at += record[i].width;
	return at;
}

unsigned layout_in_row(enum layout_field field, unsigned place)
{
	for (size_t i = 0; i < ROWS; i++)
		if (rows[i].field == field)
			return rows[i].base + layout_width(field) * place;
	return 0;
}

static bool find_in_record(unsigned address, struct layout_place *at)
{
	unsigned left = address % LAYOUT_RECORD, i = 0;

	at->place = address / LAYOUT_RECORD;
	at->part = left;
	at->field = LAYOUT_HEADER;
	if (!at->place)
		return true;
	for (; left >= record[i].width; i++)
		left -= record[i].width;
	at->field = record[i].field;
	at->part = left;
	return true;
}

bool layout_find(unsigned address, struct layout_place *at)
{
	if (address < LAYOUT_PLACES * LAYOUT_RECORD)
		return find_in_record(address, at);
	for (size_t i = 0; i < ROWS; i++) {
		unsigned width = layout_width(rows[i].field);

		/* place 0 has the header alone */
		if (address < rows[i].base + width ||
		    address >= rows[i].base + width * LAYOUT_PLACES)
			continue;
		at->field = rows[i].field;
		at->place = (address - rows[i].base) / width;
		at->part = (address - rows[i].base) % width;
		return true;
	}
	return false;
}

void layout_put_32(uint16_t *registers, uint32_t number, bool little)
{
	registers[little] = (uint16_t)(number >> 16);
	registers[!little] = (uint16_t)number;
}

static uint64_t double_bits(const struct layout_row *row)
{
	uint64_t bits;

	memcpy(&bits, &row->number, sizeof(bits));
	return row->good ? bits : BAD_DOUBLE;
}

/* A number that it cannot hold is not a number, as one that is not good. */
static uint32_t float_bits(const struct layout_row *row)
{
	float number = (float)row->number;
	uint32_t bits;

	memcpy(&bits, &number, sizeof(bits));
	return row->good && isfinite(number) ? bits : BAD_FLOAT;
}

/* So many of the last digit make 1. */
static double parts(unsigned decimals)
{
	double n = 1;

	while (decimals--)
		n *= 10;
	return n;
}

/* The lowest number means that there is none. */
static uint32_t whole_bits(const struct layout_row *row, uint32_t bad)
{
	double number = round(row->number * parts(row->decimals)), most = bad - 1.0;

	return row->good && fabs(number) <= most ? (uint32_t)(int32_t)number : bad;
}

static uint32_t age_of(const struct layout_row *row)
{
	int64_t tenths = row->age_ns / AGE_NS;

	return row->age_ns < 0 || tenths > UINT32_MAX ? UINT32_MAX : (uint32_t)tenths;
}

static uint64_t bits_of(const struct layout_row *row, enum layout_field field)
{
	switch (field) {
	case LAYOUT_DOUBLE:
		return double_bits(row);
	case LAYOUT_FLOAT:
		return float_bits(row);
	case LAYOUT_LONG:
		return whole_bits(row, BAD_LONG);
	case LAYOUT_SHORT:
		return whole_bits(row, BAD_SHORT);
	case LAYOUT_QUALITY:
		return row->quality;
	case LAYOUT_AGE:
		return age_of(row);
	case LAYOUT_ALARM:
		return row->alarm;
	case LAYOUT_COUNT:
		return row->count;
	case LAYOUT_DECIMALS:
		return row->decimals;
	case LAYOUT_FLAGS:
		return row->flags;
	case LAYOUT_HEADER:
		break;
	}
	return 0;
}

uint16_t layout_register(const struct layout_row *row, const struct layout_place *at, bool little)
{
	unsigned width = layout_width(at->field);
	unsigned above = little ? at->part : width - 1 - at->part;

	return (uint16_t)(bits_of(row, at->field) >> (16 * above));
}

bool layout_number(const uint16_t *registers, enum layout_field field, unsigned decimals,
                   bool little, double *number)
{
	unsigned width = layout_width(field);
	uint64_t bits = 0;
	uint32_t half;
	float single;

	for (unsigned i = 0; i < width; i++)
		bits = bits << 16 | registers[little ? width - 1 - i : i];
	half = (uint32_t)bits;
	if (field == LAYOUT_DOUBLE) {
		memcpy(number, &bits, sizeof(*number));
		return isfinite(*number);
	}
	if (field == LAYOUT_FLOAT) {
		memcpy(&single, &half, sizeof(single));
		*number = single;
		return isfinite(single);
	}
	*number = (field == LAYOUT_SHORT ? (int16_t)half : (int32_t)half) / parts(decimals);
	return half != (field == LAYOUT_SHORT ? BAD_SHORT : BAD_LONG);
}
