/* SPDX-License-Identifier: MIT */
/* Waits on a word of shared memory, and wakes the processes that wait on it. */
#pragma once

#include <stdint.h>

/*
 * Futex on a word that other processes share. Never FUTEX_PRIVATE.
 * segment_wait: sleep while *word == seen, at most timeout_ns (negative: no limit). Returns 0 when
 * woken or when the word has changed, -ETIMEDOUT, -EINTR, -EFAULT when the memory is gone.
 */
int segment_wait(const uint32_t *word, uint32_t seen, int64_t timeout_ns);
int segment_wake(const uint32_t *word, int how_many);
