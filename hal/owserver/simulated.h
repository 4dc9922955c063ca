/* SPDX-License-Identifier: MIT */
#ifndef HAL_OWSERVER_SIMULATED_H
#define HAL_OWSERVER_SIMULATED_H

#include "hal/owserver/talk.h"

/*
 * Asks the server for the names of its buses, which costs it no 1-Wire transaction: *simulated is
 * set if there are buses and all are simulated (owserver --fake, --tester, --mock), cleared
 * otherwise. Returns 0, or what talk_exchange() says.
 */
int simulated_ask(struct talk *talk, int64_t deadline_ns, bool *simulated);

#endif
