/* SPDX-License-Identifier: MIT */
/* The alarm machine of a lane: what the states of alarm_fsm.h ask of the bus. */
#pragma once

#include "src/daemon/engine/state.h"

/* The target is back, and may be another or have another driver: has it an alarm search now? */
void alarm_ask_again(struct alarm_machine *m, struct lane *lane);

/* Does the lane hold writes back for the machine? */
bool alarm_holds(const struct alarm_machine *m);
/*
 * Does the machine let an output go first? It does before the first list and before each SetAlarm
 * that is compared, for as many writes as the lane has outputs.
 */
bool alarm_yields(struct alarm_machine *m, const struct lane *lane);
/*
 * Go on as far as there is something to do without asking; true: the slot has what to ask next.
 * alarm_started() must follow if it was given to the bus.
 */
bool alarm_run(struct alarm_machine *m, struct lane *lane, struct slot *slot);
void alarm_started(struct alarm_machine *m, struct lane *lane);
void alarm_answered(struct alarm_machine *m, struct lane *lane, const struct slot *slot,
                    const struct bus_answer *answer);
/* A write or read of the lane went through. */
void alarm_passed(struct alarm_machine *m);
/* When the machine has to run though nothing was answered; INT64_MAX: only then. */
int64_t alarm_wake(const struct alarm_machine *m);
