/* SPDX-License-Identifier: MIT */
/*
 * A fiber: a function with a stack of its own that is left in the middle and entered again, as a
 * worker's thread that waits; but one at a time, in an order that a seed repeats.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <ucontext.h>

#define FIBER_STACK (512 * 1024)

struct fiber {
	ucontext_t context, outside;
	char *stack;
	void (*run)(void *ctx);
	void *ctx;
	bool ended;
	/* what the sanitizers want to know of it */
	void *fake, *outside_fake, *thread, *outside_thread;
	const void *outside_bottom;
	size_t outside_size;
};

void fiber_begin(struct fiber *fiber, void (*run)(void *ctx), void *ctx);
/* Until it leaves or ends. */
void fiber_enter(struct fiber *fiber);
/* Inside it: back to who entered. */
void fiber_leave(struct fiber *fiber);
void fiber_end(struct fiber *fiber);
