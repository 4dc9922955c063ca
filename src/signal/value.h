/* SPDX-License-Identifier: MIT */
/*
 * Values of signals and their texts. A value is 64 bits: a double's bits for float and double, a
 * signed integer for the other number types; strings have none. All functions use the C locale and
 * allocate nothing.
 */
#ifndef SIGNAL_VALUE_H
#define SIGNAL_VALUE_H

#include <stdbool.h>

#include "src/libows/ows.h"

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
 * Text from a bus to a value: blanks trimmed, the whole text must parse, and be whole for all but
 * float and double. Outside the type: nearest limit, *quality OWS_Q_LOW or OWS_Q_HIGH, else
 * OWS_Q_GOOD; for bool all above 0 is 1. -EILSEQ: does not parse (NAN and INF too), or has a
 * fraction. Also "yes/no/on/off" for bool is refused here: buses say 0 and 1.
 */
int value_from_text(enum ows_type type, const char *text, size_t len, int64_t *value,
                    uint8_t *quality);
/* The same for a bus that knows the number. */
int value_from_number(enum ows_type type, double number, int64_t *value, uint8_t *quality);

/* What a control program sets: -ERANGE the type cannot hold it, -EINVAL NaN and infinity. */
int value_set_double(enum ows_type type, double number, int64_t *value);
int value_set_integer(enum ows_type type, int64_t number, int64_t *value);
/* Can a value found in shared memory be one of this type? */
bool value_holds(enum ows_type type, int64_t value);

/*
 * InitValue, SafeValue and `owsctl set`: decimal point, bool also on/off yes/no true/false; exact,
 * nothing is clamped or rounded to an integer. -ERANGE the type cannot hold it, -EINVAL no number,
 * or no whole one. Not for strings.
 */
int value_parse(enum ows_type type, const char *text, int64_t *value);

/*
 * The text that goes to the bus and to the screen: integers decimal, float and double the shortest
 * text that reads back equal, bool 1 or 0. Returns its length. Not for strings.
 */
int value_to_text(enum ows_type type, int64_t value, char text[VALUE_TEXT_MAX]);

#endif
