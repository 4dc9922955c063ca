/* SPDX-License-Identifier: MIT */
/* What the alarm machine changes in the table and in the journal. */
#pragma once

#include "src/daemon/engine/state.h"

struct signal *alarm_signal(struct engine *e, const struct alarm_item *item);
/* The item at iAlarmPos, NULL: none. */
struct alarm_item *alarm_current(struct alarm_machine *m);

/* The latch of the item was read and is not 0. */
void engine_alarm_raised(struct engine *e, struct lane *lane, struct alarm_item *item);
/*
 * Its latch was read 0, or its device is not listed, or the item looks for it no more: what the
 * journal has of it ends with the return.
 */
void engine_alarm_rests(struct engine *e, struct alarm_item *item);
/*
 * The device's por was read non-zero: its outputs are not what was written. The journal and the log
 * show it of one of its signals. seen: it was read before, so it is news.
 */
void engine_power_on_reset(struct lane *lane, const struct device *d, const struct signal *shown,
                           bool seen);
/* Its bus has no alarm search: no look will tell that its alarm returned, so it ends now. */
void engine_alarm_polled(struct engine *e, struct alarm_item *item);
/* The same of all items: they are ordinary inputs. */
void engine_alarm_polls(struct engine *e, struct alarm_machine *m);
