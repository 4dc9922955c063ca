/* SPDX-License-Identifier: MIT */
/*
 * Whether a value is kept, by the Record of its signal: pure functions of the rule, of what was
 * kept last and of what there is now. Times are arguments.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/config/read/config.h"
#include "src/public/ows.h"

/*
 * A value, of which the rule heeds type, quality, measured_ns, number of float and double, and
 * integer: of the other number types, and of a string a hash of its text.
 */
/* Of one signal. All zero: nothing is known, so that the next value is kept. */
struct rule_kept {
	bool any;
	struct ows_value sample;
	int64_t slot; /* of Record's interval: that which was looked at last */
};

/* The signal has changed, or may have: is the sample kept? */
bool rule_change(const struct config_record *rule, const struct rule_kept *kept,
                 const struct ows_value *sample);
/*
 * Has another slot of the interval begun, by the wall clock? Then *kept is in that slot; without
 * an interval never.
 */
bool rule_tick(const struct config_record *rule, struct rule_kept *kept, int64_t wall_ns);
/* At the tick that begins a slot: is the newest sample kept? */
bool rule_interval(const struct rule_kept *kept, const struct ows_value *sample);
/*
 * May there have been a value between the last that was kept and this one, which the rule would
 * have kept? measured: how often since the last look; changes are not counted, and of several
 * measurements one may have been a change. unseen_ns: the recorder has not looked since then,
 * though it was due; 0: it has. ticked: at a tick.
 */
bool rule_missed(const struct config_record *rule, const struct rule_kept *kept, uint32_t measured,
                 bool ticked, int64_t unseen_ns, int64_t now_ns);
/* The wall-clock time of the next tick; INT64_MAX without an interval. */
int64_t rule_next_tick(const struct config_record *rule, int64_t wall_ns);
