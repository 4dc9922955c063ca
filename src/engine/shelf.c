/* SPDX-License-Identifier: MIT */
/* The places of shelved limit alarms in the image. */
#include <errno.h>

#include "src/engine/limit.h"
#include "src/engine/shelf.h"
#include "src/engine/state.h"
#include "src/shm/entries.h"

const struct ows_shelf_entry *engine_shelf(const struct engine *e, const struct signal *s)
{
	return s->limit.shelf ? &e->image->shelves[s->limit.shelf - 1] : NULL;
}

static unsigned free_place(const struct engine *e)
{
	unsigned i = 0;

	while (i < OWS_SHELVES && e->image->shelves[i].record)
		i++;
	return i;
}

int engine_shelf_put(struct engine *e, struct signal *s, const struct ows_shelf_entry *entry)
{
	unsigned place = s->limit.shelf ? s->limit.shelf - 1u : free_place(e);

	if (place == OWS_SHELVES)
		return -ENOSPC;
	image_shelf(e->image, place, entry);
	s->limit.shelf = (uint8_t)(place + 1);
	return 0;
}

void engine_shelf_free(struct engine *e, struct signal *s)
{
	const struct ows_shelf_entry none = {0};

	image_shelf(e->image, s->limit.shelf - 1u, &none);
	s->limit.shelf = 0;
}

void engine_shelves_resume(struct engine *e)
{
	const struct ows_shelf_entry none = {0};

	for (uint32_t row = 0; row < e->table.count; row++) {
		e->table.signals[row].limit.shelf = 0;
		e->table.signals[row].limit.alarm.shelved = false;
	}
	for (unsigned i = 0; i < OWS_SHELVES; i++) {
		uint32_t record = e->image->shelves[i].record;
		struct signal *s;

		if (!record)
			continue;
		s = record <= e->table.count ? &e->table.signals[record - 1] : NULL;
		if (!s || !s->item->limits.any || s->limit.shelf) {
			image_shelf(e->image, i, &none);
			continue;
		}
		s->limit.shelf = (uint8_t)(i + 1);
		limit_shelve(&s->limit.alarm);
	}
}
