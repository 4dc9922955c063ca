/* SPDX-License-Identifier: MIT */
/* Sleep on a word of the shared memory, and wake who sleeps there. */
#ifndef SHM_FUTEX_H
#define SHM_FUTEX_H

#include <stdint.h>

/*
 * Futex on a word that other processes share. Never FUTEX_PRIVATE.
 * segment_wait: sleep while *word == seen, at most timeout_ns (negative: no limit). 0 woken or
 * changed, -ETIMEDOUT, -EINTR, -EFAULT the memory is gone.
 */
int segment_wait(const uint32_t *word, uint32_t seen, int64_t timeout_ns);
int segment_wake(const uint32_t *word, int how_many);

#endif
