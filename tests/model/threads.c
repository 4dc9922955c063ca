/* SPDX-License-Identifier: MIT */
/* The threads of a scenario: stacks that stop and go on, and how they are put aside and back. */
/* The checked form of longjmp() takes a change of stacks for an error */
#undef _FORTIFY_SOURCE
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "tests/model/search.h"

#define BELOW 512 /* of the frame that stops: what it may have put there itself */

static _Alignas(16) char stacks[THREADS][STACK];
static jmp_buf back; /* to the search */
static ucontext_t start, nobody;
static void (*thread_entry)(void);

/* For plain reads by a thread that alone writes there. */
static void show_last(void)
{
	for (unsigned i = 0; i < x.memory.locations; i++) {
		const struct location *l = &x.memory.location[i];

		write_plain(x.tracked[i].at, x.tracked[i].size, l->messages[l->count - 1].value);
	}
}

void thread_stop(struct thread *t)
{
	t->low = (char *)__builtin_frame_address(0) - BELOW;
	if (_setjmp(t->at) == 0)
		_longjmp(back, 1);
}

static void run_entry(void)
{
	struct thread *t = x.running;

	thread_entry();
	t->state = DONE;
	t->history = 0;
	thread_stop(t);
	abort();
}

void thread_begin(struct thread *t, void (*entry)(void))
{
	unsigned i = thread_number(t);

	getcontext(&start);
	start.uc_stack.ss_sp = stacks[i];
	start.uc_stack.ss_size = STACK;
	start.uc_link = NULL;
	makecontext(&start, run_entry, 0);
	t->state = READY;
	t->history = t->loads = 0;
	thread_entry = entry;
	x.running = t;
	if (_setjmp(back) == 0)
		swapcontext(&nobody, &start);
	x.running = NULL;
}

void thread_go_on(struct thread *t)
{
	show_last();
	x.running = t;
	if (_setjmp(back) == 0)
		_longjmp(t->at, 1);
	x.running = NULL;
}

void snapshot_save(struct snapshot *s)
{
	size_t used = 0;

	s->memory = x.memory;
	memcpy(s->threads, x.threads, sizeof(x.threads));
	for (unsigned i = 0; i < x.kept_count; i++) {
		memcpy(s->kept + used, x.kept[i].at, x.kept[i].size);
		used += x.kept[i].size;
	}
	for (unsigned i = 0; i < x.scenario->threads; i++) {
		size_t size = (size_t)(stacks[i] + STACK - x.threads[i].low);

		assert(size <= sizeof(s->stacks[i]));
		memcpy(s->stacks[i], x.threads[i].low, size);
	}
}

void snapshot_restore(const struct snapshot *s)
{
	size_t used = 0;

	x.memory = s->memory;
	memcpy(x.threads, s->threads, sizeof(x.threads));
	for (unsigned i = 0; i < x.kept_count; i++) {
		memcpy(x.kept[i].at, s->kept + used, x.kept[i].size);
		used += x.kept[i].size;
	}
	for (unsigned i = 0; i < x.scenario->threads; i++)
		memcpy(x.threads[i].low, s->stacks[i],
		       (size_t)(stacks[i] + STACK - x.threads[i].low));
}
