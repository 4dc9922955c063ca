/* SPDX-License-Identifier: MIT */
/*
 * When changes of values go out to the streams. The first change after a silence goes at once. The
 * next ones wait, 20 times as long as the last ones cost in CPU time, but 20 ms at least and 100 ms
 * at most. So few streams are quick, and many of them cost a twentieth of a processor. All streams
 * go together: what one gets, the others get too, and it is made once. Times in ns. Pure.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct pace {
	bool waits;       /* something changed that has not gone out */
	int64_t sent_ns;  /* when something went out last; 0: never */
	int64_t spent_ns; /* CPU time since */
	uint64_t sent;    /* cursor (recent.h) of what may have gone out */
};

/* So many ns of CPU time were spent for streams. */
void pace_spent(struct pace *pace, int64_t cpu_ns);
/* When what waits is due; INT64_MAX: nothing waits. It may be later when asked again. */
int64_t pace_due(const struct pace *pace);
/* True: it is due, and all up to the cursor newest goes out now. */
bool pace_send(struct pace *pace, int64_t now_ns, uint64_t newest);

/*
 * Pieces of events that several streams need, made once: streams that know the same get the same.
 * A few of the last ones are kept.
 */

#define SHARED 4

/* How far a stream is with the changes of values. Cursors are those of recent.h. */
struct position {
	uint32_t generation; /* of the table */
	uint64_t seen;       /* all up to it was written */
	uint64_t until;      /* of the event that is being written */
	bool within;         /* an event is being written */
	bool some;           /* it has rows already */
};

struct shared {
	struct {
		struct position from, to;
		int64_t made_ns;
		char *text;
		size_t len;
	} pieces[SHARED];
	unsigned next;
};

/*
 * The piece that leads on from *position, which then is where it leads to; NULL: it was not made in
 * the last 20 ms. An older one has ages that are wrong by now. The text is valid until
 * shared_keep().
 */
const char *shared_find(const struct shared *shared, struct position *position, int64_t now_ns,
                        size_t *len);
/* Keep a copy, if there is memory. */
void shared_keep(struct shared *shared, const struct position *from, const struct position *to,
                 int64_t now_ns, const char *text, size_t len);
void shared_forget(struct shared *shared);
