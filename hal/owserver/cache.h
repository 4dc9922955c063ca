/* SPDX-License-Identifier: MIT */
#ifndef HAL_OWSERVER_CACHE_H
#define HAL_OWSERVER_CACHE_H

#include "hal/owserver/talk.h"

/*
 * For how long does the server answer from its cache? *cache_ns gets it, 0 where it does not tell.
 * 0, or as talk_exchange().
 */
int cache_ask(struct talk *talk, int64_t deadline_ns, int64_t *cache_ns);

#endif
