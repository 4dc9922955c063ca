/* SPDX-License-Identifier: MIT */
/* What each state of the alarm machine asks of the bus. */
#ifndef ENGINE_ALARM_ASK_H
#define ENGINE_ALARM_ASK_H

#include "src/engine/state.h"

/* True: *request is what the present state asks; false: it asks nothing now. */
bool alarm_ask(struct alarm_machine *m, const struct lane *lane, struct alarm_request *request,
               int64_t now_ns);

#endif
