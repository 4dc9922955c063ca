/* SPDX-License-Identifier: MIT */
/* Which alarms are told, how severe they are, and when they wait. Pure. */
#pragma once

#include <stdbool.h>

#include "src/public/ows.h"

/* Above LimitHH, below LimitLL, and what a device reports by itself. */
bool rules_critical(const struct ows_alarm *alarm);
/* Is it a kind of limit alarm, of which a signal has one? */
bool rules_of_limit(uint8_t kind);
/* Does it wake people? That a critical one has returned does not. */
bool rules_urgent(const struct ows_alarm *alarm);
/* Is the signal meant? The last pattern that fits decides; !PATTERN: it is not. */
bool rules_chosen(const char *patterns, const char *name);
/* Is that minute of the day in the hours, which may go over midnight? NULL: there are none. */
bool rules_quiet(const char *hours, unsigned minute);
