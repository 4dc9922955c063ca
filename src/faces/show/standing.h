/* SPDX-License-Identifier: MIT */
/* The present alarms of a signal, as list and watch show them. */
#pragma once

#include <stdbool.h>

#include "src/faces/show/json.h"
#include "src/public/ows.h"

/* The alarms of the signal of an ows_find() id; none where none are known, as for the driver. */
struct ows_alarm_state standing_of(struct ows *h, int id);

/* Can the signal have alarms? */
bool standing_possible(const struct ows_alarm_state *state);
/* An alarm that is shelved does not stand. */
bool standing_any(const struct ows_alarm_state *state);
/*
 * Does the signal have an alarm that is not acknowledged? A device alarm cannot be
 * acknowledged.
 */
bool standing_wants_eyes(const struct ows_alarm_state *state);

#define STANDING_WORDS 64
/*
 * "! high", "high, acknowledged", "! high, returned", "! device", "high, shelved"; "-" without an
 * alarm. The mark stands before an alarm that is not acknowledged. Returns words.
 */
const char *standing_text(const struct ows_alarm_state *state, char words[STANDING_WORDS]);

/* The member "alarms": an array with an object for each present alarm; and the member "shelved". */
void standing_json(struct json *json, const struct ows_alarm_state *state);
/* The same by the number in ows_info(). Is it of a limit, and has nobody acknowledged it? */
bool standing_find(struct ows *h, int signal, struct ows_info *info, struct ows_alarm_state *state);
