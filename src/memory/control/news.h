/* SPDX-License-Identifier: MIT */
/*
 * News: a thread that writes to a socket or wakes a word walks all watches and sleepers that peers
 * have put there. So a thread of its own does it, for which the engine only leaves word; what is
 * found to be slow is rung less often. Mostly nobody sleeps on the image: that the engine sees for
 * itself, and wakes no thread then.
 */
#pragma once

#include "src/memory/control/private.h"

/* 0 or a negative errno. */
int news_open(struct control *c);
void news_close(struct control *c);
int news_start(struct control *c);
void news_stop(struct control *c);
/* What the thread does when its bell has rung: how long nothing is due then; -1: until it rings. */
int64_t news_turn(struct control *c);
/*
 * The engine's thread: wake two sleepers of the word at most. True: there may be others, which the
 * thread of news has to wake. For a second after a wake that took long it wakes none, and is true.
 */
bool news_wake(struct control *c, const uint32_t *word);
/* Any thread: the seat is to be rung; news_ring() has to follow. */
void news_due(struct control *c, unsigned seat);
/* Any thread, never blocks; word: of an image with sleepers to be woken too, or NULL. */
void news_ring(struct control *c, const uint32_t *word);
/* The socket at the seat may be rung from now on. */
void news_begin(struct control_seat *p);
/* It is rung no more. False: it is being rung this moment. */
bool news_end(struct control_seat *p);
