/* SPDX-License-Identifier: MIT */
/*
 * The kernel tells that slaves and masters come and go. Where that cannot be had (no such right,
 * another name space) the lists are read now and then.
 */
#pragma once

#include <stdbool.h>

/* The socket; -1: none. */
int w1_uevents_open(void);
void w1_uevents_close(int *uevents);
/* Takes what there is, never blocks. True: slaves or masters came or went, or some was missed. */
bool w1_uevents_taken(int uevents);
