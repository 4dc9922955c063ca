/* SPDX-License-Identifier: MIT */
/*
 * A thread beside the engine's that works on what may hang, a disk or a GPIO chip: it is asked to
 * end, and given up if it does not.
 */
#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct own_thread {
	pthread_t thread;
	bool running;
	uint32_t stop, ended; /* futex words; the thread may sleep on stop while it is 0 */
};

/* As thread_start(). */
int own_thread_start(struct own_thread *t, const char *name, size_t stack, void *(*run)(void *ctx),
                     void *ctx);
/* The thread: is it asked to end? */
bool own_thread_stops(const struct own_thread *t);
/* The thread, as the last that it does. */
void own_thread_ends(struct own_thread *t);
/*
 * Ask it to end, wake it where it sleeps on stop or on *word (NULL: nowhere else), and wait so long
 * at most. True: it has ended, or never ran.
 */
bool own_thread_stop(struct own_thread *t, uint32_t *word, int64_t timeout_ns);
