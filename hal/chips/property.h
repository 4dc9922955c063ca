/* SPDX-License-Identifier: MIT */
/*
 * A property of a device, as OWFS has it: name, type, array, access, size and life of the value,
 * and the field of an area that it is, or its functions.
 */
#pragma once

#include <math.h>

#include "hal/chips/area.h"

/* The letters are those of /structure. */
enum property_type {
	PROPERTY_DIRECTORY = 'D',
	PROPERTY_ASCII = 'a',
	PROPERTY_BINARY = 'b',
	PROPERTY_DATE = 'd',
	PROPERTY_FLOAT = 'f',
	PROPERTY_TEMPGAP = 'g',
	PROPERTY_INTEGER = 'i',
	PROPERTY_ALIAS = 'l',
	PROPERTY_PRESSURE = 'p',
	PROPERTY_TEMPERATURE = 't',
	PROPERTY_UNSIGNED = 'u',
	PROPERTY_YESNO = 'y',
	PROPERTY_BITS = 'B', /* yes/no array in one word, with .BYTE; /structure says y */
};

/* What a value of a type is; from FORM_YESNO on a number. */
enum property_form { FORM_NONE, FORM_TEXT, FORM_DATE, FORM_YESNO, FORM_WHOLE, FORM_DECIMAL };

enum property_access { ACCESS_NONE, ACCESS_READ, ACCESS_WRITE, ACCESS_BOTH };

/* How long a value stays true; the letters are those of /structure. */
enum property_life {
	LIFE_STATIC = 'f',
	LIFE_STABLE = 's',
	LIFE_VOLATILE = 'v',
	LIFE_SECOND = 't',
};

/* What an alarm item may name the property for; bits. A family in which none has one is unsaid. */
enum property_alarm {
	ALARM_LATCH = 1,  /* not 0 when something has happened, or while its condition stands */
	ALARM_STAYS = 2,  /* a latch that stays until a property that clears is written */
	ALARM_CLEARS = 4, /* a write clears the latches */
	ALARM_POR = 8,    /* not 0 after the chip has restarted */
};

enum property_index { INDEX_NONE, INDEX_NUMBERS, INDEX_LETTERS };

/* convert: a fresh reading needs a conversion, at this resolution or that of tempres. */
#define CONVERT_TEMPRES 1

typedef int property_function(struct txn *txn);

#define PROPERTY_NAME_ROOM 40

/*
 * A row of a family's table. It holds no pointer: so the tables stand in read-only memory, which
 * all processes share, and a family that is on no wire costs nothing.
 */
struct property {
	char name[PROPERTY_NAME_ROOM]; /* "temperature12", "errata/die" */
	uint8_t type, life, access;
	uint8_t how;  /* which of the family's oddities; 0: none */
	bool hidden;  /* not listed */
	bool offline; /* its functions use no wire */
	bool flag; /* tells why a chip alarms: a visit of the alarm machine reads all such once */
	uint8_t alarm;   /* enum property_alarm */
	bool holds;      /* reads as it was written, until another master writes or power is lost */
	bool negative;   /* unsigned, and a write may be below zero all the same */
	uint8_t convert; /* 9 to 12, CONVERT_TEMPRES, or 0 */
	struct {
		uint16_t count;
		uint8_t index;
		bool aggregate; /* all elements come in one transaction */
	} array;
	uint16_t takes;     /* bytes of binary that a write may have; 0: size */
	uint32_t size;      /* bytes of ascii and binary; 0: that of the type */
	uint32_t digits;    /* unsigned: each decimal digit may be as high as here; 0: any */
	uint32_t kinds;     /* KIND() of those of the family's chips that have it; 0: all have it */
	int32_t arg;        /* for functions that serve several properties */
	struct field field; /* what it is; .area 0: it has functions */
	/*
	 * Of a measurement, the range that the chip measures by its data sheet, widened by the
	 * error that the data sheet allows at its ends: a chip at 125 degrees may rightly report
	 * 127. Where a result is computed from a register, the range that the register holds. Of a
	 * limit or another setting, its unit alone. Both 0: the type says what there is to say.
	 */
	struct {
		double least, most;
		char unit[6];    /* UTF-8; "": a plain number */
		int8_t decimals; /* of its resolution; -1: not known */
		bool starves;    /* a thermometer that reports 85 or 127.94 when it lacks power */
	} measures;
};

/* For property.kinds: a chip whose device.kind is n. No chip is of KIND(0). */
#define KIND(n) (UINT32_C(1) << (n))

/* What no field can say of a property. */
struct property_how {
	property_function *read; /* NULL: of the field */
	property_function *write;
	/* What the other elements are when one is written; NULL: what read says. */
	property_function *merge;
	struct field set; /* what is written, if that is another field than is read */
};

enum property_form property_form(uint8_t type);
/* Bytes of a whole value, of one element, as owserver states it. */
unsigned property_size(const struct property *property);
/* Is it a directory in /structure? */
bool property_has_entries(const struct property *property);

/* A function that reads or writes nothing: -EOPNOTSUPP. */
int property_refuse(struct txn *txn);
/* The value of a property that is a text. -EMSGSIZE: the request has no room for it. */
int property_text(struct txn *txn, const char *text);

/*
 * Rows of a family's table: PROPERTY("set_alarm", UNSIGNED, STABLE, BOTH, .digits = 331, ...).
 * Arrays are ELEMENTS, read one by one, or AGGREGATE, read in one transaction.
 */
/* clang-format off */
#define PROPERTY(text, kind, life_, access_, ...) \
	{.name = text, .type = PROPERTY_##kind, .life = LIFE_##life_, \
	 .access = ACCESS_##access_, __VA_ARGS__}
#define ELEMENTS(n, index_) .array = {(n), INDEX_##index_, false}
#define AGGREGATE(n, index_) .array = {(n), INDEX_##index_, true}
/* Any number, or any word, stands behind the dot: elements that cannot be counted. */
#define SPARSE(index_) .array = {0, INDEX_##index_, false}
#define PROPERTY_DIR(path) PROPERTY(path, DIRECTORY, STATIC, NONE, .hidden = false)
/* A branch of the wire. /structure has it as a file: OWFS lists nothing below it there. */
#define PROPERTY_BRANCH(path, ...) PROPERTY(path, DIRECTORY, VOLATILE, NONE, .size = 8, __VA_ARGS__)
/* clang-format on */
/* FIELD(REGISTERS, .at = 3, .shift = 2) in a row of a table of properties. */
#define FIELD(...) .field = {.area = __VA_ARGS__}
#define MEASURES(least, most, decimals, unit) .measures = {least, most, unit, decimals, false}
#define DEGREES_C "\u00b0C"
/* A setting, or what no data sheet gives a range for: a unit, and any number. "": a plain one. */
#define IN_UNIT(unit) MEASURES(-HUGE_VAL, HUGE_VAL, -1, unit)
/* What counts, in a register of so many bits. */
#define COUNTS_TO(most) MEASURES(0, most, 0, "")
/* The same in a property_how, of what is written. */
#define SET(...) .set = {.area = __VA_ARGS__}
/* The rows of a table that nearly every memory has: "memory", and below "pages" its pages. */
#define AREA_MEMORY(area_, bytes_) \
	PROPERTY("memory", BINARY, VOLATILE, BOTH, .size = (bytes_), FIELD(area_))
#define AREA_PAGES(area_, pages_, bytes_) \
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(pages_, NUMBERS), \
	         .size = (bytes_), FIELD(area_))
