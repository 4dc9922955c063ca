/* SPDX-License-Identifier: MIT */
/* Threads of owsd beside the engine's. */
#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * Start a thread with a stack of so many bytes, or of the least that the machine gives a thread,
 * and a name of at most 15 characters, which it has from its first line on. All signals are
 * blocked in it, as the first thread takes them, but SIGBUS: for a fault of the thread's own the
 * kernel would kill the process. Returns 0 or a negative errno; then *thread means nothing.
 */
int thread_start(pthread_t *thread, const char *name, size_t stack, void *(*run)(void *ctx),
                 void *ctx);

/*
 * Let whom the thread has just woken run first, where both share a CPU: its answer saves a sleep
 * then. On a busy machine others run too, and a yield may cost more than any sleep: after one that
 * took long there is none for 32 times as long. rest_ns: 0 at first, the caller's to keep. False:
 * there was none.
 */
bool thread_yield(int64_t *rest_ns);
