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
