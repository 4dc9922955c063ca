/* SPDX-License-Identifier: MIT */
/* What an owserver says of itself. Both return 0, or the error of talk_exchange(). */
#pragma once

#include "hal/owserver/talk.h"

/*
 * Ask for how long the server answers from its cache: its setting timeout/volatile. *cache_ns: the
 * time, 0 if the server does not report it.
 */
int server_ask_cache(struct talk *talk, int64_t deadline_ns, int64_t *cache_ns);
/*
 * Ask for the names of its buses, which costs it no 1-Wire transaction. *simulated: there are
 * buses, and all are simulated (owserver --fake, --tester, --mock).
 */
int server_ask_simulated(struct talk *talk, int64_t deadline_ns, bool *simulated);
