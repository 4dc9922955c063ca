/* SPDX-License-Identifier: MIT */
/* The checked form of longjmp() takes a change of stacks for an error */
#undef _FORTIFY_SOURCE
#include "explore.h"

#include "src/libows/handle.h"
#include "src/shm/segment.h"

#include <assert.h>
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <ucontext.h>

#define STACK      32768
#define BELOW      512 /* of the frame that stops: what it may have put there itself */
#define DEPTH      200
#define KEEPS      4
#define KEPT_BYTES 512
#define STATES_MAX (UINT64_C(1) << 24)

enum { LOAD, STORE, RMW, CAS, FENCE, WAIT, WOKEN, WAKE };
static const char *const kinds[] = {
	[LOAD] = "load", [STORE] = "store", [RMW] = "read-modify-write",
	[CAS] = "compare-and-swap", [FENCE] = "fence", [WAIT] = "futex wait",
	[WOKEN] = "woken", [WAKE] = "futex wake",
};
static const char *const orders[] = {
	[__ATOMIC_RELAXED] = "relaxed", [__ATOMIC_CONSUME] = "consume",
	[__ATOMIC_ACQUIRE] = "acquire", [__ATOMIC_RELEASE] = "release",
	[__ATOMIC_ACQ_REL] = "acq_rel", [__ATOMIC_SEQ_CST] = "seq_cst",
};

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

static struct {
	const struct scenario *scenario;
	const struct mutant *mutant;
	unsigned bit;
	struct exploration *result;
	struct weak memory;
	struct thread threads[THREADS];
	struct thread *running; /* NULL: the search itself */
	jmp_buf search;
	ucontext_t start, nobody;
	void (*entry)(void);
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
	uint64_t *seen, seen_room;
	unsigned depth; /* steps on the way to here */
	struct site *sites, *last_site;
} x;
static _Alignas(16) char stacks[THREADS][STACK];

/* All that one step may change. */
struct snapshot {
	struct weak memory;
	struct thread threads[THREADS];
	char kept[KEPT_BYTES];
	char stacks[THREADS][STACK / 4];
};
static struct snapshot *snapshots;
static struct {
	unsigned thread;
	struct step step;
	bool killed;
} path[DEPTH];

static uint64_t read_plain(const volatile void *at, size_t size)
{
	return size == 8 ? *(const volatile uint64_t *)at : *(const volatile uint32_t *)at;
}

static void write_plain(volatile void *at, size_t size, uint64_t value)
{
	if (size == 8)
		*(volatile uint64_t *)at = value;
	else
		*(volatile uint32_t *)at = (uint32_t)value;
}

/* --- Threads ---------------------------------------------------------------------------------- */

static void stop_here(struct thread *t)
{
	t->low = (char *)__builtin_frame_address(0) - BELOW;
	if (_setjmp(t->at) == 0)
		_longjmp(x.search, 1);
}

static void run_entry(void)
{
	struct thread *t = x.running;

	x.entry();
	t->state = DONE;
	t->history = 0;
	stop_here(t);
	abort();
}

static void begin(struct thread *t, void (*entry)(void))
{
	unsigned i = (unsigned)(t - x.threads);

	getcontext(&x.start);
	x.start.uc_stack.ss_sp = stacks[i];
	x.start.uc_stack.ss_size = STACK;
	x.start.uc_link = NULL;
	makecontext(&x.start, run_entry, 0);
	t->state = READY;
	t->history = t->loads = 0;
	x.entry = entry;
	x.running = t;
	if (_setjmp(x.search) == 0)
		swapcontext(&x.nobody, &x.start);
	x.running = NULL;
}

/* For plain reads by a thread that alone writes there. */
static void show_last(void)
{
	for (unsigned i = 0; i < x.memory.locations; i++) {
		const struct location *l = &x.memory.location[i];

		write_plain(x.tracked[i].at, x.tracked[i].size, l->messages[l->count - 1].value);
	}
}

static void go_on(struct thread *t)
{
	show_last();
	x.running = t;
	if (_setjmp(x.search) == 0)
		_longjmp(t->at, 1);
	x.running = NULL;
}

static unsigned number(const struct thread *t)
{
	return (unsigned)(t - x.threads);
}

static void save(struct snapshot *s)
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

static void restore(const struct snapshot *s)
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

/* --- Sites and how they are weakened ---------------------------------------------------------- */

static const struct site *meet(struct site *site, int kind, int order)
{
	if (!site->same) {
		for (struct site *s = x.sites; s && !site->same; s = s->next)
			if (s->line == site->line && s->kind == kind &&
			    strcmp(s->file, site->file) == 0)
				site->same = s;
		if (!site->same) {
			site->same = site;
			site->kind = kind;
			site->order = order;
			if (x.last_site)
				x.last_site->next = site;
			else
				x.sites = site;
			x.last_site = site;
		}
	}
	site->same->scenarios |= 1u << x.bit;
	return site->same;
}

struct site *explore_sites(void)
{
	return x.sites;
}

/* The order that is left, -1: nothing at all; -2: there is no such way. */
static int weakened(const struct site *site, unsigned way, const char **words)
{
	static const struct {
		bool fence;
		int order, left;
		const char *words;
	} ways[] = {
		{false, __ATOMIC_ACQUIRE, __ATOMIC_RELAXED, "acquire to relaxed"},
		{false, __ATOMIC_RELEASE, __ATOMIC_RELAXED, "release to relaxed"},
		{false, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE, "acq_rel without release"},
		{false, __ATOMIC_ACQ_REL, __ATOMIC_RELEASE, "acq_rel without acquire"},
		{false, __ATOMIC_SEQ_CST, __ATOMIC_ACQUIRE, "seq_cst without release"},
		{false, __ATOMIC_SEQ_CST, __ATOMIC_RELEASE, "seq_cst without acquire"},
		{true, __ATOMIC_ACQUIRE, -1, "acquire fence taken away"},
		{true, __ATOMIC_RELEASE, -1, "release fence taken away"},
		{true, __ATOMIC_SEQ_CST, __ATOMIC_ACQ_REL, "seq_cst fence to acq_rel"},
		{true, __ATOMIC_SEQ_CST, -1, "seq_cst fence taken away"},
	};

	for (unsigned i = 0; i < sizeof(ways) / sizeof(ways[0]); i++) {
		if (ways[i].order != site->order || ways[i].fence != (site->kind == FENCE) ||
		    (site->kind == LOAD && ways[i].left == __ATOMIC_ACQUIRE) ||
		    (site->kind == STORE && ways[i].left == __ATOMIC_RELEASE) || way-- != 0)
			continue;
		*words = ways[i].words;
		return ways[i].left;
	}
	return -2;
}

const char *explore_way(const struct site *site, unsigned way)
{
	const char *words = NULL;

	weakened(site, way, &words);
	return words;
}

static int order_of(const struct site *site, int order)
{
	const char *words;

	return x.mutant && x.mutant->site == site ? weakened(site, x.mutant->way, &words) : order;
}

/* --- What threads call ------------------------------------------------------------------------ */

static struct step *ask(const struct step *step)
{
	struct thread *t = x.running;

	t->step = *step;
	stop_here(t);
	t->history = mix(t->history, t->step.result);
	t->history = mix(t->history, (uint64_t)t->step.kind);
	t->loads += t->step.kind == LOAD;
	return &t->step;
}

/* Where an address is tracked: -1 not at all. A half of a double word has a shift. */
static int find(const volatile void *address, size_t size, unsigned *shift)
{
	const volatile char *at = address;

	for (unsigned i = 0; i < x.memory.locations; i++) {
		*shift = 0;
		if (at == x.tracked[i].at && size == x.tracked[i].size)
			return (int)i;
		if (size == 4 && x.tracked[i].size == 8 && at >= x.tracked[i].at &&
		    at < x.tracked[i].at + 8) {
			*shift = at == x.tracked[i].at ? 0 : 32;
			return (int)i;
		}
	}
	return -1;
}

uint64_t access_load(const volatile void *at, size_t size, int order, struct site *site)
{
	struct step step = {.kind = LOAD};
	int location = x.running ? find(at, size, &step.shift) : -1;

	if (location >= 0) {
		step.site = meet(site, LOAD, order);
		step.order = order_of(step.site, order);
		step.location = (unsigned)location;
		step.result = ask(&step)->result >> step.shift;
		return size == 4 ? (uint32_t)step.result : step.result;
	}
	if (size == 8 && x.running) {
		const volatile char *halves = at;

		/* Two words at once: taken for two loads, which is weaker */
		if (find(halves, 4, &step.shift) >= 0 || find(halves + 4, 4, &step.shift) >= 0) {
			uint64_t low = access_load(halves, 4, order, site);

			return low | access_load(halves + 4, 4, order, site) << 32;
		}
	}
	return read_plain(at, size);
}

void access_store(volatile void *at, size_t size, uint64_t value, int order, struct site *site)
{
	struct step step = {.kind = STORE, .value = value};
	int location = x.running ? find(at, size, &step.shift) : -1;

	if (location < 0) {
		write_plain(at, size, value);
		return;
	}
	assert(x.tracked[location].size == size);
	step.site = meet(site, STORE, order);
	step.order = order_of(step.site, order);
	step.location = (unsigned)location;
	if (size == 4)
		step.value = (uint32_t)value;
	ask(&step);
}

static uint64_t combine(enum access_rmw how, uint64_t a, uint64_t b)
{
	switch (how) {
	case ACCESS_ADD:
		return (uint32_t)(a + b);
	case ACCESS_SUB:
		return (uint32_t)(a - b);
	case ACCESS_OR:
		return a | b;
	case ACCESS_AND:
		return a & (uint32_t)b;
	}
	return 0;
}

uint64_t access_rmw(volatile void *at, size_t size, enum access_rmw how, uint64_t operand,
                    int order, struct site *site)
{
	struct step step = {.kind = RMW, .how = how, .value = operand};
	int location = x.running ? find(at, size, &step.shift) : -1;
	uint64_t before;

	assert(size == 4);
	if (location < 0) {
		before = read_plain(at, size);
		write_plain(at, size, combine(how, before, operand));
		return before;
	}
	step.site = meet(site, RMW, order);
	step.order = order_of(step.site, order);
	step.location = (unsigned)location;
	return ask(&step)->result;
}

bool access_cas(volatile void *at, size_t size, uint64_t *expected, uint64_t value, int order,
                int failed, struct site *site)
{
	struct step step = {.kind = CAS, .value = value, .failed_order = failed};
	int location = x.running ? find(at, size, &step.shift) : -1;
	uint64_t before, wanted = *expected;

	assert(size == 4);
	if (location < 0) {
		before = read_plain(at, size);
		if (before == wanted)
			write_plain(at, size, value);
	} else {
		step.site = meet(site, CAS, order);
		step.order = order_of(step.site, order);
		step.location = (unsigned)location;
		step.expected = wanted;
		before = ask(&step)->result;
	}
	*expected = before;
	return before == wanted;
}

void access_fence(int order, struct site *site)
{
	struct step step = {.kind = FENCE};

	if (!x.running)
		return;
	step.site = meet(site, FENCE, order);
	step.order = order_of(step.site, order);
	if (step.order < 0)
		return;
	/* Only one that is sequentially consistent has to do with other threads */
	if (step.order == __ATOMIC_SEQ_CST)
		ask(&step);
	else
		weak_fence(&x.memory, number(x.running), step.order);
}

/* In the place of src/shm/futex.c; time does not pass here. */
int segment_wait(const uint32_t *word, uint32_t seen, int64_t timeout_ns)
{
	struct step step = {.kind = WAIT, .order = __ATOMIC_RELAXED, .expected = seen};
	int location = find(word, 4, &step.shift);

	(void)timeout_ns;
	assert(x.running && location >= 0);
	step.location = (unsigned)location;
	ask(&step);
	return 0;
}

/* In the place of src/libows/orphan.c: there are no names, and no time passes. */
bool orphan_look(struct ows *h, int64_t now_ns)
{
	(void)h;
	(void)now_ns;
	return false;
}

int handle_orphan(struct ows *h, int64_t now_ns)
{
	(void)h;
	(void)now_ns;
	return 0;
}

int segment_wake(const uint32_t *word, int how_many)
{
	struct step step = {.kind = WAKE, .value = (uint64_t)how_many};
	int location = find(word, 4, &step.shift);

	if (!x.running || location < 0)
		return 0;
	step.location = (unsigned)location;
	return (int)ask(&step)->result;
}

void explore_fail(const char *format, ...)
{
	va_list args;

	va_start(args, format);
	vsnprintf(x.result->why, sizeof(x.result->why), format, args);
	va_end(args);
	x.result->failed = true;
	if (x.running)
		stop_here(x.running);
}

void explore_forget(uint64_t all_that_matters)
{
	x.running->history = mix(1, all_that_matters);
	x.running->loads = 0;
}

unsigned explore_loads(void)
{
	return x.running->loads;
}

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

/* --- The search ------------------------------------------------------------------------------- */

static void wake(struct thread *t, struct step *s)
{
	unsigned woken = 0;

	for (unsigned i = 0; i < x.scenario->threads && woken < s->value; i++) {
		struct thread *sleeper = &x.threads[i];

		if (sleeper->state == ASLEEP && sleeper->step.location == s->location) {
			sleeper->state = READY;
			sleeper->step.kind = WOKEN;
			woken++;
		}
	}
	s->result = woken;
	weak_unlock(&x.memory, number(t));
}

/* Message from may be chosen; returns false if it may not. */
static bool perform(struct thread *t, unsigned from)
{
	struct step *s = &t->step;
	struct weak *m = &x.memory;
	unsigned i = number(t);
	bool swaps;

	switch (s->kind) {
	case LOAD:
		s->result = weak_load(m, i, s->location, from, s->order);
		break;
	case STORE:
		if (!weak_room(m, s->location, from))
			return false;
		weak_store(m, i, s->location, from, s->value, s->order);
		break;
	case RMW:
		if (!weak_room(m, s->location, from))
			return false;
		s->result = weak_load(m, i, s->location, from, s->order);
		weak_replace(m, i, s->location, from, combine(s->how, s->result, s->value),
		               s->order);
		break;
	case CAS:
		swaps = m->location[s->location].messages[from].value == s->expected;
		if (swaps && !weak_room(m, s->location, from))
			return false;
		s->result = weak_load(m, i, s->location, from,
		                        swaps ? s->order : s->failed_order);
		if (swaps)
			weak_replace(m, i, s->location, from, s->value, s->order);
		break;
	case FENCE:
		weak_fence(m, i, s->order);
		break;
	case WAIT:
		/* The kernel compares under a lock, under which it also wakes */
		weak_lock(m, i);
		if (from < weak_oldest(m, i, s->location))
			return false;
		s->result = weak_load(m, i, s->location, from, __ATOMIC_RELAXED);
		weak_unlock(m, i);
		if (s->result == s->expected)
			t->state = ASLEEP;
		break;
	case WOKEN:
		weak_lock(m, i);
		break;
	case WAKE:
		weak_lock(m, i);
		wake(t, s);
		break;
	}
	return true;
}

/* The messages from which a thread's step may choose: [*first, *end). */
static void choices(const struct thread *t, unsigned *first, unsigned *end)
{
	const struct step *s = &t->step;

	if (s->kind == FENCE || s->kind == WOKEN || s->kind == WAKE) {
		*first = 0;
		*end = 1;
		return;
	}
	*first = weak_oldest(&x.memory, number(t), s->location);
	*end = x.memory.location[s->location].count;
}

static uint64_t hash_all(void)
{
	uint64_t h = weak_hash(&x.memory);

	for (unsigned i = 0; i < x.scenario->threads; i++) {
		const struct thread *t = &x.threads[i];

		h = mix(mix(h, t->history), (uint64_t)t->state * 2 + t->killed);
		if (t->state != DONE) {
			h = mix(h, (uint64_t)t->step.kind << 32 | t->step.location);
			h = mix(mix(h, t->step.value), (uintptr_t)t->step.site);
		}
	}
	for (unsigned i = 0; i < x.kept_count; i++) {
		const unsigned char *bytes = x.kept[i].at;

		for (size_t j = 0; j < x.kept[i].size; j++)
			h = mix(h, bytes[j]);
	}
	return h != 0 ? h : 1;
}

static void put_seen(uint64_t *table, uint64_t room, uint64_t h)
{
	uint64_t i = h & (room - 1);

	while (table[i] != 0)
		i = (i + 1) & (room - 1);
	table[i] = h;
}

static void grow(void)
{
	uint64_t room = x.seen_room * 2, *table = calloc(room, sizeof(*table));

	if (!table)
		abort();
	for (uint64_t i = 0; i < x.seen_room; i++)
		if (x.seen[i] != 0)
			put_seen(table, room, x.seen[i]);
	free(x.seen);
	x.seen = table;
	x.seen_room = room;
}

static bool seen_before(uint64_t h)
{
	for (uint64_t i = h & (x.seen_room - 1); x.seen[i] != 0; i = (i + 1) & (x.seen_room - 1))
		if (x.seen[i] == h)
			return true;
	if (x.result->states * 2 > x.seen_room)
		grow();
	put_seen(x.seen, x.seen_room, h);
	return false;
}

static bool over(void)
{
	return x.result->failed || x.result->too_large;
}

static void visit(unsigned depth);

static void take_step(unsigned depth, struct thread *t, unsigned from, bool kill)
{
	const struct scenario *s = x.scenario;
	unsigned i = number(t);

	if (kill) {
		t->killed = true;
		begin(t, s->reborn[i]);
	} else {
		if (!perform(t, from))
			return;
		path[depth].step = t->step;
		if (t->state == READY)
			go_on(t);
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

	if (seen_before(hash_all()))
		return;
	if (++x.result->states >= STATES_MAX || depth + 1 >= DEPTH) {
		x.result->too_large = true;
		return;
	}
	save(&snapshots[depth]);
	for (unsigned i = 0; i < x.scenario->threads; i++) {
		struct thread *t = &x.threads[i];
		bool mortal = x.scenario->reborn[i] && !t->killed;
		unsigned first, end;

		if (t->state != READY)
			continue;
		any = true;
		choices(t, &first, &end);
		for (unsigned from = first; from < end + mortal; from++) {
			take_step(depth, t, from, from == end);
			if (over())
				return;
			restore(&snapshots[depth]);
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
	x.seen_room = 1 << 12;
	x.seen = calloc(x.seen_room, sizeof(*x.seen));
	if (!snapshots || !x.seen)
		abort();
	scenario->setup();
	for (unsigned i = 0; i < scenario->threads; i++)
		begin(&x.threads[i], scenario->run[i]);
	visit(0);
	free(x.seen);
	if (loud && result->failed)
		print_path();
}
