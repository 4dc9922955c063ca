/* SPDX-License-Identifier: MIT */
/* What a step does to the memory, and from which messages it may choose. */
#include "tests/model/search.h"

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
	weak_unlock(&x.memory, thread_number(t));
}

/* Message from may be chosen; returns false if it may not. */
bool step_perform(struct thread *t, unsigned from)
{
	struct step *s = &t->step;
	struct weak *m = &x.memory;
	unsigned i = thread_number(t);
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
		s->result = weak_load(m, i, s->location, from, swaps ? s->order : s->failed_order);
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
void step_choices(const struct thread *t, unsigned *first, unsigned *end)
{
	const struct step *s = &t->step;

	if (s->kind == FENCE || s->kind == WOKEN || s->kind == WAKE) {
		*first = 0;
		*end = 1;
		return;
	}
	*first = weak_oldest(&x.memory, thread_number(t), s->location);
	*end = x.memory.location[s->location].count;
}
