/* SPDX-License-Identifier: MIT */
/*
 * Pieces of events that several streams need, made once: streams that know the same get the same
 * (pace.h). A few of the last ones are kept.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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
