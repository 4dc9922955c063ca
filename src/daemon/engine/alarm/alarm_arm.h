/* SPDX-License-Identifier: MIT */
/* The arming of alarm items and the restarts of their devices. */
#pragma once

#include "src/daemon/engine/state.h"

/*
 * Is the item looked at in this cycle? Not while its device waits for another try to clear its por.
 */
bool alarm_takes_part(const struct alarm_item *item, int64_t now_ns);

/* por was read: not 0, which is a restart if none is known; 0, or 0 was written and read back. */
void alarm_por_set(struct alarm_machine *m, struct lane *lane, struct alarm_item *item);
void alarm_por_clear(struct alarm_machine *m, struct engine *e, const struct alarm_item *item);

/* Why a restart is not over: SetAlarm was refused, is not defined; por was refused or stays set. */
void alarm_set_failed(struct lane *lane, struct alarm_item *item, int err);
void alarm_set_missing(struct lane *lane, struct alarm_item *item);
void alarm_por_failed(struct lane *lane, struct alarm_item *item, int err);

/* The item with a SetAlarm that is to be compared with the chip now; NULL: none. */
struct alarm_item *alarm_to_arm(const struct alarm_machine *m, int64_t now_ns);
/* When there is one, as things stand; INT64_MAX: never. */
int64_t alarm_to_arm_ns(const struct alarm_machine *m);
/* The answer to that, or to the write after it. */
void alarm_arm_answered(struct alarm_machine *m, struct lane *lane, const struct bus_answer *answer,
                        const char *data);
/* A device came back: its SetAlarm is compared again, and its next por is a restart. */
void alarm_rearm(struct alarm_machine *m, struct engine *e, uint32_t device);
