/* SPDX-License-Identifier: MIT */
/* The signals in the order of their last change. */
#include <stdlib.h>

#include "src/faces/web/recent.h"

void recent_free(struct recent *recent)
{
	free(recent->cursor);
	free(recent->mark);
	free(recent->older);
	free(recent->newer);
	*recent = (struct recent){.first = -1, .last = -1, .newest = recent->newest};
}

bool recent_make(struct recent *recent, int count)
{
	size_t n = (size_t)count + 1;

	recent_free(recent);
	recent->cursor = calloc(n, sizeof(*recent->cursor));
	recent->mark = calloc(n, sizeof(*recent->mark));
	recent->older = calloc(n, sizeof(*recent->older));
	recent->newer = calloc(n, sizeof(*recent->newer));
	if (!recent->cursor || !recent->mark || !recent->older || !recent->newer) {
		recent_free(recent);
		return false;
	}
	recent->count = count;
	return true;
}

uint64_t recent_next(struct recent *recent, int64_t now_ns)
{
	uint64_t now = (uint64_t)now_ns / 1000;

	recent->newest = now > recent->newest ? now : recent->newest + 1;
	return recent->newest;
}

static void take_out(struct recent *recent, int i)
{
	int older = recent->older[i], newer = recent->newer[i];

	*(older < 0 ? &recent->first : &recent->newer[older]) = newer;
	*(newer < 0 ? &recent->last : &recent->older[newer]) = older;
}

void recent_change(struct recent *recent, int i, uint64_t mark, int64_t now_ns)
{
	if (i < 0 || i >= recent->count)
		return;
	if (recent->cursor[i] && recent->mark[i] == mark)
		return;
	recent->mark[i] = mark;
	if (recent->cursor[i])
		take_out(recent, i);
	recent->cursor[i] = recent_next(recent, now_ns);
	recent->older[i] = recent->last;
	recent->newer[i] = -1;
	*(recent->last < 0 ? &recent->first : &recent->newer[recent->last]) = i;
	recent->last = i;
}

int recent_after(const struct recent *recent, uint64_t cursor)
{
	int found = -1;

	for (int i = recent->last; i >= 0 && recent->cursor[i] > cursor; i = recent->older[i])
		found = i;
	return found;
}
