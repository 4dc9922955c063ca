/* SPDX-License-Identifier: MIT */
/*
 * A bell wakes one thread that waits in poll or epoll for its descriptor. It stays rung until it is
 * read, and ringing never blocks.
 */
#pragma once

/* A descriptor, or a negative errno. It is closed with close(). */
int bell_open(void);
/* Any thread. */
void bell_ring(int bell);
/* It is silent until the next ring. */
void bell_clear(int bell);
