/* SPDX-License-Identifier: MIT */
/*
 * The pages of other machines: each is asked for its summary every ten seconds, by a thread of its
 * own, so that a name server that is silent holds up that one alone.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/faces/show/json.h"

struct others;

/*
 * Begin with those of a list (src/config/read/others.h); what is wrong in it is left out. NULL:
 * none stands there, or no memory.
 */
struct others *others_begin(const char *list);
/* Ask no more. Waits for nothing: a thread that waits for an answer takes what is left with it. */
void others_end(struct others *others);
unsigned others_count(const struct others *others);
/* Is that the list that it began with? */
bool others_has(const struct others *others, const char *list);

/*
 * Elements of an array: name, page, whether it answers (null: it was not asked yet), since when
 * (seconds), age of the summary, why it does not, and the summary where it does.
 */
void others_json(struct others *others, struct json *json, int64_t now_ns);
