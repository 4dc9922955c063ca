/* SPDX-License-Identifier: MIT */
/* Requests of the alarm machine that fail: counted, told, and asked again later. */
#pragma once

#include "src/daemon/engine/state.h"

/* Why the item is shown not to come, as enum ows_unarmed; 0: it is not. */
uint8_t alarm_shown(const struct signal *s);
/* Is that of arming, not of a visit (the reads of PorAlarm and LatchAlarm, ResetLatch)? */
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
