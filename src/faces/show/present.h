/* SPDX-License-Identifier: MIT */
/*
 * The alarms of a signal that are present: that stand, are shelved, or cannot be armed; and that an
 * output reads otherwise than it was written.
 */
#pragma once

#include <stdbool.h>

#include "src/faces/show/json.h"
#include "src/faces/show/reading.h"
#include "src/faces/show/when.h"
#include "src/ground/signal/error.h"
#include "src/public/ows.h"

/* The present alarms of a signal, as list and watch show them. */

/* The alarms of the signal of an ows_find() id; none where none are known, as for the driver. */
struct ows_alarm_state standing_of(struct ows *h, int id);

/* Can the signal have alarms? */
bool standing_possible(const struct ows_alarm_state *state);
/* An alarm that is shelved does not stand. */
bool standing_any(const struct ows_alarm_state *state);
/* Does its limit alarm want an acknowledgement? */
bool standing_unacknowledged(const struct ows_alarm_state *state);
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

struct present {
	int signal, decimals; /* decimals as in ows_info() */
	const char *name, *kind, *state;
	int64_t since_ns; /* 0: not known */
	uint32_t occurrences;
	bool device, polled;
	uint8_t unarmed;                       /* enum ows_unarmed */
	const struct ows_alarm_state *shelved; /* NULL: it is not shelved */
};

/*
 * Calls add for each. signal as in ows_info(), id as of ows_find(); *reading is filled before with
 * what the signal has now. *alarm is valid in the call.
 */
typedef void present_add(void *ctx, const struct present *alarm);
void present_each(struct ows *h, int signal, int id, int64_t now_ns, struct reading *reading,
                  present_add *add, void *ctx);
/* Its members of an object. */
void present_json(struct json *json, const struct present *alarm, const struct when *now);
/* Why the alarm of the reading's signal is not armed, if no reading has failed since. */
const char *present_unarmed(const struct ows_alarm_state *state, const struct reading *reading,
                            char words[ERROR_WORDS]);
