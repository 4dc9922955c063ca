/* SPDX-License-Identifier: MIT */
/*
 * A value as programs show it: with its text, and in words what is wrong with it.
 *
 * Room src/faces/show: values, alarms, journals and counters in words and as JSON, for programs
 * that show them.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "src/faces/show/json.h"
#include "src/faces/show/when.h"
#include "src/ground/signal/error.h"
#include "src/public/ows.h"

#define READING_TEXT 65536 /* the longest text a layout can hold */

struct reading {
	struct ows_value value;
	int err;    /* of ows_get_text(); the value counts if this is 0 or -ESTALE */
	size_t len; /* bytes of text */
	char text[READING_TEXT];
};

/* Returns reading->err. The text of a number has all its digits. */
int reading_get(struct ows *h, int id, int64_t now_ns, struct reading *reading);
/* Round the text for a person, to at most so many decimals; -1: not known, all are shown. */
void reading_round(struct reading *reading, int decimals);
/*
 * Is there one: was it ever read or written, is it good as it is, like an attribute, or does it
 * begin with an InitValue that is not 0?
 */
bool reading_has_value(const struct reading *reading);
bool reading_good(const struct reading *reading);
/* Has the signal a value to show? */
bool reading_filled(const struct reading *reading);

#define READING_WORDS 320
/* "good", "device absent", "good (sim)". Returns words. */
const char *reading_quality(const struct reading *reading, char words[READING_WORDS]);
/* Why the value is not good, for a person. Returns words. */
const char *reading_why(const struct reading *reading, char words[READING_WORDS]);
/* The text of the value for a line or a table: strings quoted, cut to size. */
void reading_show(const struct reading *reading, char *out, size_t size);

/* A member with the value, of whose number this is the text; a string has to be clean. */
void reading_json_number(struct json *json, const char *key, const struct ows_value *value,
                         const char *text);
/* The members of a JSON object: value, quality and all that belongs to it. */
void reading_json(struct json *json, struct ows *h, const struct reading *reading,
                  const struct when *now);
