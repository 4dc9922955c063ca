/* SPDX-License-Identifier: MIT */
/*
 * The porter: a process of its own for what a peer can make slow. A descriptor that a peer has sent
 * may sleep for hours in close(); a thread that wakes a socket walks all watches that its peer has
 * put there; a memory that a peer has may be locked by it. So no thread of owsd receives what may
 * have descriptors with it, sends over a connection, or closes what a peer had or has: it gives
 * that to the porter. The porter forks a child for it, and the child does it and ends: a process
 * that ends waits for no connection. A child that hangs delays no other; the porter goes on with
 * the next.
 */
#pragma once

#include <stdbool.h>

#include "src/memory/shm/porter_order.h"

struct porter;

/* Fork the porter, before there is a thread. 0 or a negative errno. */
int porter_start(struct porter **porter);
/* End the porter after what it has; waits a second at most. NULL: does nothing. */
void porter_end(struct porter *porter);
/*
 * Give an order away: 0, and its descriptors are closed here, but those to keep. -EAGAIN:
 * the porter has too much to do, and nothing has happened. Never blocks. Without a porter (NULL,
 * or it was killed and no other is ready yet) the caller's thread does it.
 */
int porter_give(struct porter *porter, enum porter_lane lane, const struct porter_order *order);
/* Was the last order of that slot carried out, up to letting go? */
bool porter_carried(const struct porter *porter, uint32_t slot);

enum porter_event {
	PORTER_GOES_ON,
	PORTER_ENDED,   /* it was killed: the caller's threads do it all until PORTER_IS_BACK */
	PORTER_IS_BACK, /* another is ready */
	PORTER_FAILED,  /* another could not be started, or ended before it was ready */
};
/*
 * Start a porter that was killed again: after a second, later after twice as long each time, up to
 * a minute. For one thread, at least each second. The new porter begins with copies of all that
 * owsd has open, some of which may be slow to close: so it gets the lanes only when it is done with
 * that, and is killed if it takes two seconds. Never blocks.
 */
enum porter_event porter_tend(struct porter *porter, int64_t now_ns);
/* The process, for the log; 0: there is none. */
int porter_process(const struct porter *porter);
