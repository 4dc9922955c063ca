/* SPDX-License-Identifier: MIT */
/*
 * A chip family is one file that states its areas (area.h) and its properties: name, type, array,
 * access, size and life of the value as OWFS has them, and the field of an area that it is. What no
 * field can say has functions (txn.h). To add a family: write the file, and name it in families.h.
 */
#ifndef HAL_CHIPS_FAMILY_H
#define HAL_CHIPS_FAMILY_H

#include "hal/chips/area.h"

/* The letters are those of /structure. */
enum property_type {
	PROPERTY_DIRECTORY = 'D',
	PROPERTY_ASCII = 'a',
	PROPERTY_BINARY = 'b',
	PROPERTY_DATE = 'd',
	PROPERTY_FLOAT = 'f',
	PROPERTY_INTEGER = 'i',
	PROPERTY_ALIAS = 'l',
	PROPERTY_PRESSURE = 'p',
	PROPERTY_TEMPERATURE = 't',
	PROPERTY_UNSIGNED = 'u',
	PROPERTY_YESNO = 'y',
	PROPERTY_BITS = 'B', /* yes/no array in one word, with .BYTE; /structure says y */
};

enum property_access { ACCESS_NONE, ACCESS_READ, ACCESS_WRITE, ACCESS_BOTH };

/* How long a value stays true; the letters are those of /structure. */
enum property_life {
	LIFE_STATIC = 'f',
	LIFE_STABLE = 's',
	LIFE_VOLATILE = 'v',
	LIFE_SECOND = 't',
};

enum property_index { INDEX_NONE, INDEX_NUMBERS, INDEX_LETTERS };

/* convert: a fresh reading needs a conversion, at this resolution or that of tempres. */
#define CONVERT_TEMPRES 1

struct property {
	const char *name; /* "temperature12", "errata/die" */
	uint8_t type, life, access;
	bool hidden;  /* not listed */
	bool offline; /* its functions use no wire */
	bool flag; /* tells why a chip alarms: a visit of the alarm machine reads all such once */
	struct {
		uint8_t count, index;
		bool aggregate; /* all elements come in one transaction */
	} array;
	uint16_t size;           /* bytes of ascii and binary; 0: that of the type */
	bool negative;           /* unsigned, and a write may be below zero all the same */
	const char *digits;      /* unsigned: the most that each decimal digit may be; NULL: any */
	uint8_t convert;         /* 9 to 12, CONVERT_TEMPRES, or 0 */
	struct field field;      /* what it is; .area NULL: it has functions */
	const struct field *set; /* what is written, if that is another */
	int arg;                 /* for functions that serve several properties */
	bool (*visible)(const struct device *device); /* NULL: always; else no such property */
	int (*read)(struct txn *txn);                 /* NULL: of the field */
	int (*write)(struct txn *txn);
	/* What the other elements are when one is written; NULL: what read says. */
	int (*merge)(struct txn *txn);
	uint16_t takes; /* bytes of binary that a write may have; 0: size */
};

struct family {
	uint8_t code;
	bool thermometer; /* takes Convert T, has its resolution in the scratchpad */
	bool fixed;       /* ... but its resolution cannot be changed */
	bool alarms;      /* answers the conditional search */
	bool is_virtual;  /* no chip: a table of /statistics and the like */
	const char *type; /* "DS18B20" */
	/* NULL: type. Some families hold several chips. */
	const char *(*type_of)(const struct device *device);
	/* Which of them? Until that is known, requests may be for properties of any. NULL: it is. */
	bool (*is_known)(const struct device *device);
	/* The chip was away or has restarted: what of device.own is void? NULL: all of it. */
	void (*forget)(struct device *device);
	const struct property *properties; /* sorted by name, the hidden ones too */
	unsigned count;
};

/* Never NULL: families that are not known have the common properties. */
const struct family *family_of(uint8_t code);
/* The families of this build, in the order of their codes; NULL behind the last. */
const struct family *family_nth(unsigned n);
const char *family_type(const struct device *device);

/* By its name without extension (len bytes); NULL: no such property of this device. */
const struct property *family_property(const struct family *family, const struct device *device,
                                       const char *name, size_t len);
/*
 * All properties by their names, the common ones of devices merged in: the first behind prev (NULL:
 * the first of all). NULL: that was the last. Without a device, also those that only some chips
 * of the family have.
 */
const struct property *family_next(const struct family *family, const struct device *device,
                                   const struct property *prev);
/* What reads it, and what writes it: the property's function, or the field's; NULL: nothing. */
typedef int property_function(struct txn *txn);
property_function *property_reader(const struct property *property);
property_function *property_writer(const struct property *property);
/* Bytes of a whole value, of one element, as owserver states it. */
unsigned property_size(const struct property *property);

extern const struct family family_common;
#define FAMILY(code) extern const struct family family_##code;
#include "hal/chips/families.h"
#undef FAMILY

/*
 * Rows of a family's table: PROPERTY("set_alarm", UNSIGNED, STABLE, BOTH, .digits = "331", ...).
 * Arrays are ELEMENTS, read one by one, or AGGREGATE, read in one transaction.
 */
/* clang-format off */
#define PROPERTY(text, kind, life_, access_, ...) \
	{.name = (text), .type = PROPERTY_##kind, .life = LIFE_##life_, \
	 .access = ACCESS_##access_, __VA_ARGS__}
#define ELEMENTS(n, index_) .array = {(n), INDEX_##index_, false}
#define AGGREGATE(n, index_) .array = {(n), INDEX_##index_, true}
#define PROPERTY_DIR(path) \
	{.name = (path), .type = PROPERTY_DIRECTORY, .life = LIFE_STATIC, .access = ACCESS_NONE}
/* clang-format on */
#define PROPERTIES(table) .properties = (table), .count = sizeof(table) / sizeof((table)[0])

#endif
