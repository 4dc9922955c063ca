/* SPDX-License-Identifier: MIT */
/* The signals in the order of their last change. */
#include <stdlib.h>

#include "src/faces/web/recent.h"

void recent_free(struct recent *recent)
{
	free(recent->of);
	*recent = (struct recent){.first = -1, .last = -1, .newest = recent->newest};
}

bool recent_make(struct recent *recent, int count)
{
	recent_free(recent);
	recent->of = calloc((size_t)count + 1, sizeof(*recent->of));
	recent->count = recent->of ? count : 0;
	return recent->of;
}

uint64_t recent_next(struct recent *recent, int64_t now_ns)
{
	uint64_t now = (uint64_t)now_ns / 1000;

	recent->newest = now > recent->newest ? now : recent->newest + 1;
	return recent->newest;
}

static void take_out(struct recent *recent, const struct recent_change *change)
{
	int older = change->older, newer = change->newer;

	*(older < 0 ? &recent->first : &recent->of[older].newer) = newer;
	*(newer < 0 ? &recent->last : &recent->of[newer].older) = older;
}

void recent_change(struct recent *recent, int i, uint64_t mark, int64_t now_ns)
{
	struct recent_change *change;

	if (i < 0 || i >= recent->count)
		return;
	change = &recent->of[i];
	if (change->cursor && change->mark == mark)
		return;
	if (change->cursor)
		take_out(recent, change);
	*change = (struct recent_change){
		.cursor = recent_next(recent, now_ns),
		.mark = mark,
		.older = recent->last,
		.newer = -1,
	};
	*(recent->last < 0 ? &recent->first : &recent->of[recent->last].newer) = i;
	recent->last = i;
}

int recent_after(const struct recent *recent, uint64_t cursor)
{
	int found = -1;

	for (int i = recent->last; i >= 0 && recent->of[i].cursor > cursor; i = recent->of[i].older)
		found = i;
	return found;
}
