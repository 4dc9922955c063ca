/* SPDX-License-Identifier: MIT */
/*
 * How a handle becomes a controller, and gets the memory that belongs to the present image: it
 * connects, takes what owsd hands it, and connects again after a restart.
 */
#pragma once

#include <stdint.h>

struct ows;
struct ows_map;

/*
 * Get the memory that belongs to the map, until then at most; meet_take() puts it in place. Returns
 * 0; -EAGAIN: owsd has not handed it out yet, call again; -ENOENT: no owsd listens; or why owsd
 * refuses.
 */
int meet(struct ows *h, const struct ows_map *map, int64_t until_ns);
/* Use the memory of meet() from now on, with the promise and the person of before. */
void meet_take(struct ows *h);
/* Leave in order: the commands stay in force. A forked child only closes what is its own. */
void meet_leave(struct ows *h);
