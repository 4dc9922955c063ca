/* SPDX-License-Identifier: MIT */
/*
 * The texts of OWFS: numbers right-aligned in 12 characters, printed with %G to six digits, yes/no
 * one character, elements joined by commas. Pure functions.
 */
#pragma once

#include "hal/chips/property.h"

/* What stands behind the dot of an array's name; 0 and up: an element. WORD: of SPARSE alone. */
enum extension {
	EXTENSION_ALL = -1,
	EXTENSION_BYTE = -2,
	EXTENSION_NONE = -3,
	EXTENSION_WORD = -4
};
/* "A" as an extension; the letters behind it follow. */
#define EXTENSION_LETTERS 0x10000
/* Which element of the array it is, by number or letter. */
static inline int extension_element(int extension)
{
	return extension & (EXTENSION_LETTERS - 1);
}

/*
 * Split "PIO.BYTE" (len bytes) into name length and extension as the property's array has it.
 * *name_len: up to the last dot that starts an extension. Returns the extension; whether it fits
 * the property is extension_fits().
 */
int extension_split(const char *text, size_t len, size_t *name_len);
bool extension_fits(const struct property *property, int extension);
/* ".BYTE", ".ALL", ".3", ".C" or "" (no array). Returns the length. */
int extension_print(const struct property *property, int extension, char text[8]);

/* One number of this type, and its length; -EMSGSIZE. */
int format_number(uint8_t type, double number, char *text, size_t room);
/* The value in txn as text of the extension; length or -EMSGSIZE. Not for text and binary. */
int format_value(const struct property *property, int extension, const struct txn *txn, char *text,
                 size_t room);
/* The text of one number that is the whole value of the extension. */
int format_alone(const struct property *property, int extension, double number, char *text,
                 size_t room);
/* Does the text stand for exactly one number, and which? */
bool format_is_number(const struct property *property, int extension);
double format_as_number(const struct property *property, int extension, const struct txn *txn);

/* The length without blanks, and the end of line or of string, at the end. */
size_t text_end(const char *text, size_t len);
/*
 * The text without the blanks around it, and the end of line or of string behind it. False: nothing
 * is left, or too much for a number or a date.
 */
#define TEXT_ROOM 64
bool text_trimmed(const char *text, size_t len, char copy[TEXT_ROOM]);
/* Decimal digits: what else strtod() takes is no value of a property. Returns 0 or -EINVAL. */
int text_decimal(const char *text, double *number);
/*
 * The other way. With one element of an aggregate only that element is set: the others have to be
 * in txn. -EINVAL, and txn is as before: the text is not the whole of a value in the range of the
 * property. Blanks around it and an end of line or of string behind it do not count.
 */
int parse_value(const struct property *property, int extension, const char *text, size_t len,
                struct txn *txn);
/* The same of a number, for what is one: see format_is_number(). */
int take_number(const struct property *property, int extension, double number, struct txn *txn);
/* Is the text the whole of a value in the range of the property? Not for text and binary. */
bool format_takes(const struct property *property, int extension, const char *text, size_t len);
/* Part n of a comma list; false: there is none. */
bool list_part(const char *text, size_t len, unsigned n, const char **part, size_t *part_len);
/* Has the list as many elements as the property, and can the property take each of them? */
bool list_fits(const struct property *property, const char *text, size_t len);
