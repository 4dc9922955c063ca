/* SPDX-License-Identifier: MIT */
#ifndef HAL_OWSERVER_SIMULATED_H
#define HAL_OWSERVER_SIMULATED_H

#include "hal/owserver/talk.h"

/*
 * Ask the server for the names of its buses, which costs it no 1-Wire transaction. *simulated:
 * there are buses, and all are simulated (owserver --fake, --tester, --mock). Returns 0, or the
 * error of talk_exchange().
 */
int simulated_ask(struct talk *talk, int64_t deadline_ns, bool *simulated);

#endif
