/* SPDX-License-Identifier: MIT */
/* The master: open, lost, opened again; the recovery ladder. */
#pragma once

#include "hal/native/state.h"

int64_t master_step(struct native *native, int64_t now); /* opens; when to try again */
void master_down(struct native *native, int err, const char *why);
/*
 * After a link's error, but for -ECOMM and -EBADMSG, which are no fault of the link: climb a rung
 * of the ladder (docs/native.md). True: make the transaction again. False: the target is down now,
 * and all requests are answered. Blocks as recover() of the link does.
 */
bool master_recover(struct native *native, unsigned channel, int err);
/* A transaction of the channel was good: the next error begins at the foot of the ladder. */
void master_good(struct native *native, unsigned channel);
/* While something disturbs the hardware, looks whether it still does. *next as elsewhere. */
void master_trouble(struct native *native, int64_t now, int64_t *next);
/* Now and then: take chips that were missing. *next as elsewhere. */
void master_grow(struct native *native, int64_t now, int64_t *next);
