/* SPDX-License-Identifier: MIT */
/* Between the files of the search: where it stands, its threads, and their steps. */
#pragma once

#include <setjmp.h>
#include <ucontext.h>

#include "tests/model/explore.h"

#define STACK 32768
#define KEEPS 8
#define KEPT_BYTES 512

enum { LOAD, STORE, RMW, CAS, FENCE, WAIT, WOKEN, WAKE };

/* The access before which a thread has stopped, and its result. */
struct step {
	int kind, order, failed_order;
	unsigned location, shift;
	enum access_rmw how;
	uint64_t value, expected, result;
	const struct site *site;
};

struct thread {
	jmp_buf at;
	char *low; /* of the stack in use */
	struct step step;
	enum { READY, ASLEEP, DONE } state;
	uint64_t history; /* all it has seen: where it stands and what its variables are */
	unsigned loads;
	bool killed;
};

struct search {
	const struct scenario *scenario;
	const struct mutant *mutant;
	unsigned bit;
	struct exploration *result;
	struct weak memory;
	struct thread threads[THREADS];
	struct thread *running; /* NULL: the search itself */
	struct {
		const char *name;
		volatile char *at;
		size_t size;
	} tracked[LOCATIONS];
	struct {
		void *at;
		size_t size;
	} kept[KEEPS];
	unsigned kept_count;
	unsigned depth; /* steps on the way to here */
};
/* The one that is going on. */
extern struct search x;

/* All that one step may change. */
struct snapshot {
	struct weak memory;
	struct thread threads[THREADS];
	char kept[KEPT_BYTES];
	char stacks[THREADS][STACK / 4];
};

static inline unsigned thread_number(const struct thread *t)
{
	return (unsigned)(t - x.threads);
}

/* threads.c: from its beginning, or from where it stopped, to its next access. */
void thread_begin(struct thread *t, void (*entry)(void));
void thread_go_on(struct thread *t);
/* By the thread itself: back to the search. */
void thread_stop(struct thread *t);
void snapshot_save(struct snapshot *s);
void snapshot_restore(const struct snapshot *s);

/* access.c */
uint64_t read_plain(const volatile void *at, size_t size);
void write_plain(volatile void *at, size_t size, uint64_t value);
uint64_t combine(enum access_rmw how, uint64_t a, uint64_t b);

/* sites.c: the site as it was met first; the order that the mutant has left of one, -1: nothing. */
const struct site *site_meet(struct site *site, int kind, int order);
int site_order(const struct site *site, int order);

/* step.c: the messages from which a thread's step may choose, [*first, *end). */
void step_choices(const struct thread *t, unsigned *first, unsigned *end);
/* Message from may be chosen; returns false if it may not. */
bool step_perform(struct thread *t, unsigned from);

/* seen.c: between them, was the search in the present state before? */
void seen_begin(void);
bool seen_before(void);
void seen_end(void);
