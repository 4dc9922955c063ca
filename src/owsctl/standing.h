/* SPDX-License-Identifier: MIT */
/* The alarms of a signal that stand now, as list and watch show them. */
#ifndef OWSCTL_STANDING_H
#define OWSCTL_STANDING_H

#include <stdbool.h>

#include "src/libows/ows.h"
#include "src/owsctl/json.h"

/* Of the signal of an id of ows_find(); nothing stands where nothing is known, as of the driver. */
struct ows_alarm_state standing_of(struct ows *h, int id);

/* Can the signal have alarms at all? */
bool standing_possible(const struct ows_alarm_state *state);
bool standing_any(const struct ows_alarm_state *state);
/* Does one stand that nobody has acknowledged? A device alarm cannot be acknowledged. */
bool standing_wants_eyes(const struct ows_alarm_state *state);

#define STANDING_WORDS 64
/*
 * "! high", "high, acknowledged", "! high, returned", "! device"; "-" when none stands. The mark
 * stands before what wants eyes. Returns words.
 */
const char *standing_text(const struct ows_alarm_state *state, char words[STANDING_WORDS]);

/* The member "alarms": an array with an object for each that stands. */
void standing_json(struct json *json, const struct ows_alarm_state *state);

#endif
