/* SPDX-License-Identifier: MIT */
/*
 * What the alarm machine knows in the present cycle: an item of the same device may have read or
 * written it already, and then it is not done again.
 */
#ifndef ENGINE_ALARM_KNOWN_H
#define ENGINE_ALARM_KNOWN_H

#include "src/engine/state.h"

struct signal *alarm_signal(struct engine *e, const struct alarm_item *item);
/* The item at iAlarmPos, NULL: none. */
struct alarm_item *alarm_current(struct alarm_machine *m);

/* The item of the same device for which the same was done in this cycle; NULL: none. */
const struct alarm_item *alarm_known(const struct alarm_machine *m, const struct alarm_item *i,
                                     enum alarm_deed deed);

/* The next item of the device whose latch was not read in this cycle, -1: none. */
int64_t alarm_to_collect(const struct alarm_machine *m, const struct alarm_item *i);
/* The next output below the device that gets its InitValue, a row of the table, -1: none. */
int64_t alarm_next_init(struct engine *e, struct alarm_machine *m);

#endif
