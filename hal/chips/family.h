/* SPDX-License-Identifier: MIT */
/*
 * A chip family is one file that states its properties: name, type, array, access, size and life
 * of the value as OWFS has them, and the functions that read and write it (hal/wire/txn.h). To
 * add a family: write the file, and name its table in family.c.
 */
#ifndef HAL_CHIPS_FAMILY_H
#define HAL_CHIPS_FAMILY_H

#include "hal/wire/txn.h"

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

struct chip_memory;

struct property {
	const char *name; /* "temperature12", "errata/die" */
	uint8_t type, life, access;
	bool hidden;  /* not listed */
	bool offline; /* its functions use no wire */
	struct {
		uint8_t count, index;
		bool aggregate; /* all elements come in one transaction */
	} array;
	uint16_t size;      /* bytes of ascii and binary; 0: that of the type */
	bool negative;      /* unsigned, and a write may be below zero all the same */
	const char *digits; /* unsigned: the most that each decimal digit may be; NULL: any */
	uint8_t convert;    /* 9 to 12, CONVERT_TEMPRES, or 0 */
	int arg;            /* for functions that serve several properties */
	bool (*visible)(const struct device *device); /* NULL: always; else no such property */
	int (*read)(struct txn *txn);
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
	const struct chip_memory *memory;  /* of the properties of memory.h; NULL: it has none */
	const struct property *properties; /* in any order, the hidden ones too */
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
/* Bytes of a whole value, of one element, as owserver states it. */
unsigned property_size(const struct property *property);

extern const struct family family_common;
extern const struct family family_01, family_05, family_10, family_12, family_14, family_1d,
	family_20, family_22, family_23, family_26, family_28, family_29, family_2d, family_3a,
	family_3b, family_42;

/* clang-format off */
#define PROPERTY_DIR(path) \
	{.name = (path), .type = PROPERTY_DIRECTORY, .life = LIFE_STATIC, .access = ACCESS_NONE}
/* clang-format on */
#define PROPERTIES(table) .properties = (table), .count = sizeof(table) / sizeof((table)[0])

#endif
