/* SPDX-License-Identifier: MIT */
/*
 * What the tables of the families say to programs that show or judge values: what a chip is called,
 * and the quantity that a property measures.
 */
#pragma once

#include <stdbool.h>

struct property;
struct txn;

/*
 * What the device of the path is called, as far as the path shows it: by its property ("EDS0068",
 * "HB_HUB"), else by its family's usual chip ("DS18B20"). NULL: not known. It lives as long as the
 * program.
 */
const char *model_of(const char *path);

/* The row of property.measures. */
struct quantity {
	double least, most; /* a number outside is never a true measurement */
	int decimals;       /* of its resolution; -1: not known */
	bool starves;       /* a thermometer that reports 85 or 127.94 when it lacks power */
	const char *unit;   /* "" for a plain number; UTF-8; lives as long as the program */
};

/*
 * The quantity of the property at path; false: it is none, or nothing is known of that property. A
 * limit or a setting has a unit and no range. An alias may name any chip: then the property's name
 * decides, and only what no chip can measure is out of range.
 */
bool quantity_of(const char *path, struct quantity *quantity);

/*
 * Does a reading of the property at path show that its device is there? Not its id, nor what
 * else is known without asking it, nor `present`, which may say 0.
 */
bool facts_shows_device(const char *path);
/* Has the device of the path a latch that tells of its alarm? True of an alias: it may be any. */
bool facts_latches(const char *path);

/*
 * How many digits after the point a person wants of a number in this unit; -1: all that it has.
 * Programs show so many where the configuration does not say how many; none stores or sends less
 * than the whole number for it.
 */
int unit_decimals(const char *unit);
/* The same of a quantity: no more than its resolution has. */
int quantity_decimals(const struct quantity *quantity);

/* Is the number one that the chip cannot have measured? */
bool quantity_excludes(const struct quantity *quantity, double number);
/*
 * Is one of the numbers read, of the extension as in format_value(), such a one of the property,
 * whose chip is known? It is txn->number[0] then.
 */
bool reading_excluded(const struct property *property, int extension, struct txn *txn);
