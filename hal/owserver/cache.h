/* SPDX-License-Identifier: MIT */
#ifndef HAL_OWSERVER_CACHE_H
#define HAL_OWSERVER_CACHE_H

#include "hal/owserver/talk.h"

/*
 * Ask for how long the server answers from its cache. *cache_ns: the time, 0 if the server does not
 * report it. 0, or the error of talk_exchange().
 */
int cache_ask(struct talk *talk, int64_t deadline_ns, int64_t *cache_ns);

#endif
