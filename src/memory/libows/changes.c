/* SPDX-License-Identifier: MIT */
/* Which signals changed: ows_changes(), from the image's ring of changes, with a wait for more. */
#include <errno.h>
#include <stdlib.h>

#include "hal/base/time.h"
#include "src/memory/libows/alive.h"
#include "src/memory/libows/handle.h"
#include "src/memory/libows/map.h"
#include "src/memory/libows/news.h"
#include "src/memory/shm/reader.h"

/* Bits of ows_cursor.flags. */
#define BEGUN 1u
#define LOST 2u /* it was reported that owsd is lost */

/* No ring enters 2^32 changes in that time: a number that is behind by so many looks like new. */
#define CURSOR_KEEPS_NS (3600 * NS_PER_S)

static bool make_marks(struct ows *h)
{
	uint32_t words = h->map.count / 32 + 1;
	uint32_t *marks;

	if (words <= h->mark_words)
		return true;
	marks = calloc(words, sizeof(*marks));
	if (!marks)
		return false;
	free(h->marks);
	h->marks = marks;
	h->mark_words = words;
	return true;
}

/* The cursor goes on from the present. */
static int look_at_all(const struct ows *h, struct ows_cursor *cursor, int64_t now_ns, bool lost)
{
	const struct ows_image_header *image = h->map.image;

	*cursor = (struct ows_cursor){
		.number = __atomic_load_n(&image->change_head, __ATOMIC_ACQUIRE),
		.start_id = image->start_id,
		.generation = image->generation,
		.flags = BEGUN | (lost ? LOST : 0),
		.looked_ns = now_ns,
	};
	return -EOVERFLOW;
}

static bool is_of_image(const struct ows *h, const struct ows_cursor *cursor)
{
	return cursor->flags & BEGUN && cursor->start_id == h->map.image->start_id &&
	       cursor->generation == h->map.image->generation;
}

/*
 * Copy changes from the cursor on, each record once; returns how many, -EOVERFLOW when the ring has
 * not all of them. The entry of the number head may be in work, in the place of head - count.
 */
static int copy_changes(struct ows *h, struct ows_cursor *cursor, int *signals, int n)
{
	uint32_t head = __atomic_load_n(&h->map.image->change_head, __ATOMIC_ACQUIRE);
	uint32_t count = map_count(&h->map, OWS_AREA_CHANGES), at = cursor->number;
	int got = 0;

	if (head - at >= count)
		return -EOVERFLOW;
	for (; at != head && got < n; at++) {
		const struct ows_change_entry *entry = map_entry(&h->map, OWS_AREA_CHANGES,
		                                                 at & (count - 1));
		uint32_t record = word_get(&entry->record);

		if (record == 0 || record >= h->map.count ||
		    h->marks[record / 32] & 1u << record % 32)
			continue;
		h->marks[record / 32] |= 1u << record % 32;
		signals[got++] = (int)record - 1;
	}
	for (int i = 0; i < got; i++)
		h->marks[((uint32_t)signals[i] + 1) / 32] = 0;
	word_fence(__ATOMIC_ACQUIRE);
	if (word_get(&h->map.image->change_head) - cursor->number >= count)
		return -EOVERFLOW;
	cursor->number = at;
	return got;
}

/* Returns as ows_changes(), but 0 while nothing changed. */
static int changes_look(struct ows *h, struct ows_cursor *cursor, int *signals, int n,
                        int64_t now_ns)
{
	bool alive = handle_alive(h, now_ns);
	uint32_t state = __atomic_load_n(&h->map.image->state, __ATOMIC_ACQUIRE);
	bool ended = state == OWS_STATE_STOPPED, lost = ended || !alive;
	int got;

	alive_look(h, now_ns);
	if (h->orphan || (state != OWS_STATE_LIVE && !ended) || (ended && alive_is_elsewhere(h)))
		return -ESTALE;
	if (!is_of_image(h, cursor) || lost != ((cursor->flags & LOST) != 0) ||
	    handle_age(now_ns, cursor->looked_ns) > CURSOR_KEEPS_NS)
		return look_at_all(h, cursor, now_ns, lost);
	cursor->looked_ns = now_ns;
	got = copy_changes(h, cursor, signals, n);
	return got == -EOVERFLOW ? look_at_all(h, cursor, now_ns, lost) : got;
}

/* The longest sleep: what wakes no program, as the death of owsd, is noticed after it. */
static int64_t slice(const struct ows *h, const struct ows_cursor *cursor, int64_t now_ns)
{
	int64_t dies_in = INT64_MAX;
	struct ows_sample beat;

	if (word_get(&h->map.image->state) != OWS_STATE_LIVE)
		return NEXT_OWSD_NS;
	if (!(cursor->flags & LOST) && reader_sample(map_record(&h->map, 0), &beat))
		dies_in = h->dead_after_ns - handle_age(now_ns, beat.measured_ns) + 1;
	return dies_in < ALIVE_LOOK_NS ? dies_in : ALIVE_LOOK_NS;
}

int ows_changes(struct ows *h, struct ows_cursor *cursor, int *signals, int n, int64_t timeout_ns)
{
	const uint32_t *news = &h->map.image->news;
	int64_t now_ns = ows_now(), until = wait_until(now_ns, timeout_ns);

	if (n < 1)
		return -EINVAL;
	if (map_count(&h->map, OWS_AREA_CHANGES) == 0)
		return -EOPNOTSUPP;
	if (!make_marks(h))
		return -ENOMEM;
	for (;; now_ns = ows_now()) {
		uint32_t seen = __atomic_load_n(news, __ATOMIC_ACQUIRE);
		int got = changes_look(h, cursor, signals, n, now_ns), err;
		int64_t left;

		if (got == -ESTALE)
			return news_stale(h, timeout_ns);
		if (got || until <= now_ns)
			return got;
		left = slice(h, cursor, now_ns);
		err = news_sleep(h, seen, until - now_ns < left ? until - now_ns : left);
		if (err && err != -ETIMEDOUT)
			return err;
	}
}
