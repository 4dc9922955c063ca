/* SPDX-License-Identifier: MIT */
/* What the alarm machine changes in the table, in the journal and in the log. */
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

/*
 * Is what the item is shown not to come for, as unarmed_of(), of arming, not of a visit (the reads
 * of PorAlarm and LatchAlarm, ResetLatch)?
 */
bool alarm_is_arming(uint8_t unarmed);
/*
 * Show that what is asked for property fails with err: in the image, and if that is new in the log
 * and the journal; why: " cannot be written: ". err 0: nothing fails, and why says all.
 */
void alarm_show(struct engine *e, struct alarm_item *item, enum ows_unarmed unarmed, int err,
                const char *property, const char *why);
void alarm_hide(struct engine *e, struct alarm_item *item);
/*
 * The alarm of the item can never do anything by the table of the machine, as PorAlarm or
 * LatchAlarm is missing: that is shown as long as the item is as it is. The load of the file has
 * logged it.
 * False: it can.
 */
bool alarm_show_dead(struct engine *e, const struct alarm_item *item);

/* Is the error that of the whole device? Then the quality says so, and not the alarm. */
bool alarm_of_device(int err);
/*
 * A request of a visit failed, an item error: the back-off counts as that of a read. property and
 * why as of alarm_show().
 */
void alarm_refused(struct lane *lane, struct alarm_item *item, enum ows_unarmed unarmed, int err,
                   const char *property, const char *why);
/* It succeeded; unarmed may be 0: nothing. */
void alarm_granted(struct engine *e, struct alarm_item *item, uint8_t unarmed);
/* A visit begins anew, without the failures so far. */
void alarm_visit_anew(struct engine *e, struct alarm_item *item);
