/* SPDX-License-Identifier: MIT */
/* The weak memory: stores as messages, and the views of the threads. */
#include <assert.h>
#include <string.h>

#include "tests/model/weak.h"

bool weak_stores_go_on;

static bool acquires(int order)
{
	return order == __ATOMIC_ACQUIRE || order == __ATOMIC_ACQ_REL || order == __ATOMIC_SEQ_CST;
}

static bool releases(int order)
{
	return order == __ATOMIC_RELEASE || order == __ATOMIC_ACQ_REL || order == __ATOMIC_SEQ_CST;
}

static void join(const struct weak *m, struct view *to, const struct view *with)
{
	for (unsigned i = 0; i < m->locations; i++)
		if (to->at[i] < with->at[i])
			to->at[i] = with->at[i];
}

static void reach(struct view *view, unsigned location, unsigned message)
{
	if (view->at[location] < message)
		view->at[location] = (uint8_t)message;
}

void weak_clear(struct weak *m, unsigned threads)
{
	memset(m, 0, sizeof(*m));
	m->threads = threads;
}

unsigned weak_add(struct weak *m, uint64_t value)
{
	assert(m->locations < LOCATIONS);
	m->location[m->locations].count = 1;
	m->location[m->locations].messages[0].value = value;
	return m->locations++;
}

unsigned weak_oldest(const struct weak *m, unsigned thread, unsigned location)
{
	return m->thread[thread].now.at[location];
}

uint64_t weak_load(struct weak *m, unsigned thread, unsigned location, unsigned from, int order)
{
	struct knowledge *k = &m->thread[thread];
	const struct message *message = &m->location[location].messages[from];

	assert(from >= k->now.at[location]);
	reach(&k->now, location, from);
	reach(&k->acquired, location, from);
	join(m, &k->acquired, &message->view);
	if (acquires(order))
		join(m, &k->now, &message->view);
	return message->value;
}

bool weak_room(const struct weak *m, unsigned location, unsigned from)
{
	const struct location *l = &m->location[location];

	return from + 1 == l->count || !l->messages[from + 1].glued;
}

static void shift(struct view *view, unsigned location, unsigned place)
{
	if (view->at[location] >= place)
		view->at[location]++;
}

/* Room for a message at a place; all who know of later ones still mean the same. */
static struct message *make_room(struct weak *m, unsigned location, unsigned place)
{
	struct location *l = &m->location[location];

	assert(l->count < MESSAGES);
	memmove(&l->messages[place + 1], &l->messages[place],
	        (l->count - place) * sizeof(l->messages[0]));
	if (place < l->count++) {
		for (unsigned i = 0; i < m->locations; i++)
			for (unsigned j = 0; j < m->location[i].count; j++)
				shift(&m->location[i].messages[j].view, location, place);
		for (unsigned t = 0; t < m->threads; t++) {
			struct knowledge *k = &m->thread[t];

			shift(&k->now, location, place);
			shift(&k->acquired, location, place);
			shift(&k->fenced, location, place);
			for (unsigned i = 0; i < m->locations; i++)
				shift(&k->released[i], location, place);
		}
		shift(&m->sc, location, place);
		shift(&m->lock, location, place);
	}
	return &l->messages[place];
}

static void put(struct weak *m, unsigned thread, unsigned location, unsigned place, uint64_t value,
                int order, const struct view *sequence)
{
	struct knowledge *k = &m->thread[thread];
	struct message *message = make_room(m, location, place);

	*message = (struct message){.value = value, .view = k->fenced, .glued = sequence != NULL};
	reach(&k->now, location, place);
	reach(&k->acquired, location, place);
	if (releases(order))
		k->released[location] = k->now;
	if (releases(order) || weak_stores_go_on)
		join(m, &message->view, &k->released[location]);
	if (sequence)
		join(m, &message->view, sequence);
	reach(&message->view, location, place);
}

void weak_store(struct weak *m, unsigned thread, unsigned location, unsigned behind, uint64_t value,
                int order)
{
	assert(weak_room(m, location, behind));
	put(m, thread, location, behind + 1, value, order, NULL);
}

void weak_replace(struct weak *m, unsigned thread, unsigned location, unsigned from, uint64_t value,
                  int order)
{
	struct view sequence = m->location[location].messages[from].view;

	assert(weak_room(m, location, from));
	put(m, thread, location, from + 1, value, order, &sequence);
}

void weak_fence(struct weak *m, unsigned thread, int order)
{
	struct knowledge *k = &m->thread[thread];

	if (acquires(order))
		join(m, &k->now, &k->acquired);
	if (order == __ATOMIC_SEQ_CST) {
		join(m, &m->sc, &k->now);
		k->now = k->acquired = m->sc;
	}
	if (releases(order))
		k->fenced = k->now;
}

void weak_lock(struct weak *m, unsigned thread)
{
	join(m, &m->thread[thread].now, &m->lock);
	join(m, &m->thread[thread].acquired, &m->lock);
}

void weak_unlock(struct weak *m, unsigned thread)
{
	join(m, &m->lock, &m->thread[thread].now);
}

static uint64_t hash_view(const struct weak *m, const struct view *view, uint64_t h)
{
	for (unsigned i = 0; i < m->locations; i += 4) {
		uint32_t four;

		_Static_assert(LOCATIONS % 4 == 0, "views are hashed by four");
		memcpy(&four, &view->at[i], 4);
		h = mix(h, four);
	}
	return h;
}

uint64_t weak_hash(const struct weak *m)
{
	uint64_t h = hash_view(m, &m->lock, hash_view(m, &m->sc, 1));

	for (unsigned i = 0; i < m->locations; i++) {
		const struct location *l = &m->location[i];

		h = mix(h, l->count);
		for (unsigned j = 0; j < l->count; j++)
			h = hash_view(m, &l->messages[j].view,
			              mix(mix(h, l->messages[j].value), l->messages[j].glued));
	}
	for (unsigned t = 0; t < m->threads; t++) {
		const struct knowledge *k = &m->thread[t];

		h = hash_view(m, &k->fenced, hash_view(m, &k->acquired, hash_view(m, &k->now, h)));
		for (unsigned i = 0; weak_stores_go_on && i < m->locations; i++)
			h = hash_view(m, &k->released[i], h);
	}
	return h;
}
