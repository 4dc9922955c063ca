/* SPDX-License-Identifier: MIT */
/* When changes of values go out to the streams. */
#include "src/faces/web/pace.h"

#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"

#define LEAST_NS (20 * NS_PER_MS)
#define MOST_NS (100 * NS_PER_MS)
#define TIMES 20 /* what they cost, so long they rest */

static int64_t rest(const struct pace *pace)
{
	if (pace->spent_ns >= MOST_NS / TIMES)
		return MOST_NS;
	return pace->spent_ns * TIMES > LEAST_NS ? pace->spent_ns * TIMES : LEAST_NS;
}

void pace_spent(struct pace *pace, int64_t cpu_ns)
{
	pace->spent_ns += cpu_ns;
}

int64_t pace_due(const struct pace *pace)
{
	if (!pace->waits)
		return INT64_MAX;
	return pace->sent_ns ? pace->sent_ns + rest(pace) : 0;
}

bool pace_send(struct pace *pace, int64_t now_ns, uint64_t newest)
{
	if (now_ns < pace_due(pace))
		return false;
	*pace = (struct pace){.sent_ns = now_ns, .sent = newest};
	return true;
}

/* --- Pieces that several streams need -------------------------------------------------------- */

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
