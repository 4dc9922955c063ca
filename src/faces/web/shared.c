/* SPDX-License-Identifier: MIT */
/* Pieces of events that several streams need, made once. */
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/web/shared.h"

#define VALID_NS (20 * NS_PER_MS)

static bool same(const struct position *a, const struct position *b)
{
	return a->generation == b->generation && a->seen == b->seen && a->until == b->until &&
	       a->within == b->within && a->some == b->some;
}

const char *shared_find(const struct shared *shared, struct position *position, int64_t now_ns,
                        size_t *len)
{
	for (unsigned i = 0; i < SHARED; i++) {
		if (!shared->pieces[i].text || !same(&shared->pieces[i].from, position) ||
		    now_ns - shared->pieces[i].made_ns > VALID_NS)
			continue;
		*position = shared->pieces[i].to;
		*len = shared->pieces[i].len;
		return shared->pieces[i].text;
	}
	return NULL;
}

void shared_keep(struct shared *shared, const struct position *from, const struct position *to,
                 int64_t now_ns, const char *text, size_t len)
{
	unsigned at = shared->next++ % SHARED;

	free(shared->pieces[at].text);
	shared->pieces[at].text = malloc(len + 1);
	if (!shared->pieces[at].text)
		return;
	memcpy(shared->pieces[at].text, text, len);
	shared->pieces[at].text[len] = '\0';
	shared->pieces[at].len = len;
	shared->pieces[at].from = *from;
	shared->pieces[at].to = *to;
	shared->pieces[at].made_ns = now_ns;
}

void shared_forget(struct shared *shared)
{
	for (unsigned i = 0; i < SHARED; i++)
		free(shared->pieces[i].text);
	*shared = (struct shared){0};
}
