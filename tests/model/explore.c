/* SPDX-License-Identifier: MIT */
/* Visits every state of the threads of a model, and prints the path to a fault. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/model/search.h"

#define DEPTH 200
#define STATES_MAX (UINT64_C(1) << 24)

/* clang-format off */
static const char *const kinds[] = {
	[LOAD] = "load", [STORE] = "store", [RMW] = "read-modify-write",
	[CAS] = "compare-and-swap", [FENCE] = "fence", [WAIT] = "futex wait",
	[WOKEN] = "woken", [WAKE] = "futex wake",
};
/* clang-format on */
static const char *const orders[] = {
	[__ATOMIC_RELAXED] = "relaxed", [__ATOMIC_CONSUME] = "consume",
	[__ATOMIC_ACQUIRE] = "acquire", [__ATOMIC_RELEASE] = "release",
	[__ATOMIC_ACQ_REL] = "acq_rel", [__ATOMIC_SEQ_CST] = "seq_cst",
};

struct search x;
static struct snapshot *snapshots;
static struct {
	unsigned thread;
	struct step step;
	bool killed;
} path[DEPTH];

uint64_t explore_last(const volatile void *at)
{
	for (unsigned i = 0; i < x.memory.locations; i++) {
		const struct location *l = &x.memory.location[i];

		if (x.tracked[i].at == at)
			return l->messages[l->count - 1].value;
	}
	abort();
}

bool explore_asleep(unsigned thread)
{
	return x.threads[thread].state == ASLEEP;
}

void explore_track(const char *name, volatile void *at, size_t size)
{
	unsigned i = weak_add(&x.memory, read_plain(at, size));

	x.tracked[i].name = name;
	x.tracked[i].at = at;
	x.tracked[i].size = size;
}

void explore_keep(void *at, size_t size)
{
	size_t used = size;

	for (unsigned i = 0; i < x.kept_count; i++)
		used += x.kept[i].size;
	assert(x.kept_count < KEEPS && used <= KEPT_BYTES);
	x.kept[x.kept_count].at = at;
	x.kept[x.kept_count++].size = size;
}

static bool over(void)
{
	return x.result->failed || x.result->too_large;
}

static void visit(unsigned depth);

static void take_step(unsigned depth, struct thread *t, unsigned from, bool kill)
{
	const struct scenario *s = x.scenario;
	unsigned i = thread_number(t);

	if (kill) {
		t->killed = true;
		thread_begin(t, s->reborn[i]);
	} else {
		if (!step_perform(t, from))
			return;
		path[depth].step = t->step;
		if (t->state == READY)
			thread_go_on(t);
	}
	path[depth].thread = i;
	path[depth].killed = kill;
	x.result->steps++;
	x.depth = depth + 1;
	if (!over())
		visit(depth + 1);
}

static void visit(unsigned depth)
{
	bool any = false;

	if (seen_before())
		return;
	if (++x.result->states >= STATES_MAX || depth + 1 >= DEPTH) {
		x.result->too_large = true;
		return;
	}
	snapshot_save(&snapshots[depth]);
	for (unsigned i = 0; i < x.scenario->threads; i++) {
		struct thread *t = &x.threads[i];
		bool mortal = x.scenario->reborn[i] && !t->killed;
		unsigned first, end;

		if (t->state != READY)
			continue;
		any = true;
		step_choices(t, &first, &end);
		for (unsigned from = first; from < end + mortal; from++) {
			take_step(depth, t, from, from == end);
			if (over())
				return;
			snapshot_restore(&snapshots[depth]);
		}
	}
	x.depth = depth;
	if (!any && x.scenario->end)
		x.scenario->end();
}

static void print_path(void)
{
	printf("\t%s:\n", x.result->why);
	for (unsigned i = 0; i < x.depth; i++) {
		const struct step *s = &path[i].step;

		printf("\tthread %u: ", path[i].thread);
		if (path[i].killed)
			printf("killed\n");
		else if (s->kind == FENCE || s->kind == WOKEN)
			printf("%s %s\n", s->kind == FENCE ? orders[s->order] : "", kinds[s->kind]);
		else
			printf("%s %s %s %#llx\n",
			       s->kind == WAIT || s->kind == WAKE ? "" : orders[s->order],
			       kinds[s->kind], x.tracked[s->location].name,
			       (unsigned long long)(s->kind == STORE ? s->value : s->result));
	}
}

void explore(const struct scenario *scenario, const struct mutant *mutant, unsigned bit, bool loud,
             struct exploration *result)
{
	*result = (struct exploration){0};
	x.scenario = scenario;
	x.mutant = mutant;
	x.bit = bit;
	x.result = result;
	x.kept_count = 0;
	memset(x.tracked, 0, sizeof(x.tracked));
	memset(x.threads, 0, sizeof(x.threads));
	weak_clear(&x.memory, scenario->threads);
	if (!snapshots)
		snapshots = malloc(DEPTH * sizeof(*snapshots));
	if (!snapshots)
		abort();
	seen_begin();
	scenario->setup();
	for (unsigned i = 0; i < scenario->threads; i++)
		thread_begin(&x.threads[i], scenario->run[i]);
	visit(0);
	seen_end();
	if (loud && result->failed)
		print_path();
}
