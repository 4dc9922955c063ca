/* SPDX-License-Identifier: MIT */
/* The list of devices in alarm. */
#pragma once

#include "src/daemon/engine/state.h"

/* The list of /alarm arrived, or failed. */
void alarm_take_list(struct alarm_machine *m, struct lane *lane, const char *list, size_t len);
void alarm_list_failed(struct alarm_machine *m, struct lane *lane, int err);
/* The target is back, and may be another or have another driver: has it an alarm search now? */
void alarm_ask_again(struct alarm_machine *m, struct lane *lane);
