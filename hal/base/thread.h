/* SPDX-License-Identifier: MIT */
/* Threads of owsd beside the engine's. */
#pragma once

#include <pthread.h>
#include <stddef.h>

/*
 * Start a thread with a stack of so many bytes, or of the least that the machine gives a thread,
 * and a name of at most 15 characters, which it has from its first line on. All signals are
 * blocked in it, as the first thread takes them, but SIGBUS: for a fault of the thread's own the
 * kernel would kill the process. Returns 0 or a negative errno; then *thread means nothing.
 */
int thread_start(pthread_t *thread, const char *name, size_t stack, void *(*run)(void *ctx),
                 void *ctx);
