/* SPDX-License-Identifier: MIT */
/*
 * Values of signals and their texts. A value is 64 bits: a double's bits for float and double, a
 * signed integer for the other number types; strings have none. All functions use the C locale and
 * allocate nothing.
 *
 * Room src/ground/signal: types, values and attributes of signals.
 */
#pragma once

#include <stdbool.h>

#include "src/public/ows.h"

/* Bytes of a string signal, without NUL; a multiple of 4. */
#define VALUE_STRING_MAX 1024
/* Enough for the text of any number, with NUL. */
#define VALUE_TEXT_MAX 32

bool value_type_ok(int type);
bool value_is_float(enum ows_type type);         /* float or double */
const char *value_type_name(enum ows_type type); /* "double"; "?" for no type */
/* Type of a name ("double"), -1 if there is none. */
int value_type_parse(const char *name);

double value_number(enum ows_type type, int64_t value);
int64_t value_of_double(double number); /* the bits */

/*
 * Text from a bus to a value: blanks are trimmed, the rest must be one number, and a whole number
 * for all types but float and double. A number outside the type becomes the nearest limit with
 * *quality OWS_Q_LOW or OWS_Q_HIGH, else *quality is OWS_Q_GOOD; for bool all above 0 is 1.
 * -EILSEQ: the text is no number (NAN and INF too), or has a fraction. "yes/no/on/off" for bool is
 * refused here: buses answer 0 and 1.
 */
int value_from_text(enum ows_type type, const char *text, size_t len, int64_t *value,
                    uint8_t *quality);
/* The same for a bus that knows the number. */
int value_from_number(enum ows_type type, double number, int64_t *value, uint8_t *quality);

/*
 * A number that a control program sets: -ERANGE the type cannot hold it, -EINVAL NaN and infinity.
 */
int value_set_double(enum ows_type type, double number, int64_t *value);
int value_set_integer(enum ows_type type, int64_t number, int64_t *value);
/* Can a value found in shared memory be one of this type? */
bool value_holds(enum ows_type type, int64_t value);

/*
 * The text of InitValue, SafeValue and `owsctl set` to a value: decimal point, bool also on/off
 * yes/no true/false; nothing is clamped or rounded to an integer. -ERANGE: the type cannot hold the
 * number; -EINVAL: the text is no number, or has a fraction where the type needs a whole number.
 * Not for strings.
 */
int value_parse(enum ows_type type, const char *text, int64_t *value);

/*
 * The text that goes to the bus and to the screen: integers decimal, float and double the shortest
 * text that reads back equal, bool 1 or 0. Returns its length. Not for strings.
 */
int value_to_text(enum ows_type type, int64_t value, char text[VALUE_TEXT_MAX]);
