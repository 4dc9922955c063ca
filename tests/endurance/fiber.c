/* SPDX-License-Identifier: MIT */
/* Fibers by makecontext(): functions that stop in the middle and go on later. */
#include <stdint.h>
#include <stdlib.h>

#include "tests/endurance/fiber.h"

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/common_interface_defs.h>
#define LEAVING(own, to, size) __sanitizer_start_switch_fiber((own), (to), (size))
#define ARRIVED(own, from, size) __sanitizer_finish_switch_fiber((own), (from), (size))
#else
#define LEAVING(own, to, size) ((void)0)
#define ARRIVED(own, from, size) ((void)0)
#endif

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#define MAKE_THREAD() __tsan_create_fiber(0)
#define THIS_THREAD() __tsan_get_current_fiber()
#define BE_THREAD(thread) __tsan_switch_to_fiber((thread), 0)
#define END_THREAD(thread) __tsan_destroy_fiber(thread)
#else
#define MAKE_THREAD() NULL
#define THIS_THREAD() NULL
#define BE_THREAD(thread) ((void)(thread))
#define END_THREAD(thread) ((void)(thread))
#endif

/* makecontext() passes int: a pointer is two of them at most. */
static void start(unsigned high, unsigned low)
{
	struct fiber *fiber = (struct fiber *)(uintptr_t)((uint64_t)high << 32 | low);

	ARRIVED(NULL, &fiber->outside_bottom, &fiber->outside_size);
	fiber->run(fiber->ctx);
	fiber->ended = true;
	LEAVING(NULL, fiber->outside_bottom, fiber->outside_size);
	BE_THREAD(fiber->outside_thread);
	setcontext(&fiber->outside);
}

void fiber_begin(struct fiber *fiber, void (*run)(void *ctx), void *ctx)
{
	uint64_t bits = (uintptr_t)fiber;

	*fiber = (struct fiber){.run = run, .ctx = ctx, .stack = malloc(FIBER_STACK)};
	if (!fiber->stack || getcontext(&fiber->context))
		abort();
	fiber->context.uc_stack.ss_sp = fiber->stack;
	fiber->context.uc_stack.ss_size = FIBER_STACK;
	fiber->context.uc_link = NULL;
	fiber->thread = MAKE_THREAD();
	makecontext(&fiber->context, (void (*)(void))start, 2, (unsigned)(bits >> 32),
	            (unsigned)bits);
}

void fiber_enter(struct fiber *fiber)
{
	fiber->outside_thread = THIS_THREAD();
	LEAVING(&fiber->outside_fake, fiber->stack, FIBER_STACK);
	BE_THREAD(fiber->thread);
	swapcontext(&fiber->outside, &fiber->context);
	ARRIVED(fiber->outside_fake, NULL, NULL);
}

void fiber_leave(struct fiber *fiber)
{
	LEAVING(&fiber->fake, fiber->outside_bottom, fiber->outside_size);
	BE_THREAD(fiber->outside_thread);
	swapcontext(&fiber->context, &fiber->outside);
	ARRIVED(fiber->fake, &fiber->outside_bottom, &fiber->outside_size);
}

void fiber_end(struct fiber *fiber)
{
	if (!fiber->stack)
		return;
	END_THREAD(fiber->thread);
	free(fiber->stack);
	fiber->stack = NULL;
}
