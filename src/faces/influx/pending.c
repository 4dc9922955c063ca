/* SPDX-License-Identifier: MIT */
/* Lines that wait in memory, one behind the other, each behind its time and its length. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/influx/pending.h"

#define TIME_TEXT 24 /* a blank, 20 letters, a line feed, NUL */
#define FIRST_ROOM 65536u

struct head {
	int64_t time_ns;
	uint32_t size; /* with NUL */
	bool dated;    /* by the wall clock */
};

void pending_free(struct pending *pending)
{
	free(pending->data);
	*pending = (struct pending){.first = pending->first + pending->lines,
	                            .dropped = pending->dropped,
	                            .dropped_ns = pending->dropped_ns};
}

/* Of the line at that place. */
static struct head head_at(const struct pending *pending, size_t at)
{
	struct head head;

	memcpy(&head, pending->data + at, sizeof(head));
	return head;
}

static void remove_first(struct pending *pending, size_t bytes, unsigned lines)
{
	pending->len -= bytes;
	pending->lines -= lines;
	pending->first += lines;
	if (pending->len)
		memmove(pending->data, pending->data + bytes, pending->len);
}

static void drop_quarter(struct pending *pending)
{
	unsigned lines = 0;
	size_t at = 0;

	for (; at < pending->len && at < pending->room / 4; lines++) {
		struct head head = head_at(pending, at);

		at += sizeof(head) + head.size;
		if (!head.dated && head.time_ns > pending->dropped_ns)
			pending->dropped_ns = head.time_ns;
	}
	remove_first(pending, at, lines);
	pending->dropped += lines;
}

static bool room_for_line(struct pending *pending, size_t size)
{
	while (pending->len + size > pending->room) {
		size_t room = pending->room ? 2 * pending->room : FIRST_ROOM;
		char *data = room <= PENDING_BYTES ? realloc(pending->data, room) : NULL;

		if (data) {
			pending->data = data;
			pending->room = room;
		} else if (pending->len) {
			drop_quarter(pending);
		} else {
			return false;
		}
	}
	return true;
}

static void add(struct pending *pending, struct head head, const char *series, const char *fields)
{
	size_t size = strlen(series) + 1 + strlen(fields) + 1;

	head.size = (uint32_t)size;
	if (!room_for_line(pending, sizeof(head) + size)) {
		pending->dropped++;
		return;
	}
	memcpy(pending->data + pending->len, &head, sizeof(head));
	pending->len += sizeof(head);
	snprintf(pending->data + pending->len, size, "%s %s", series, fields);
	pending->len += size;
	pending->lines++;
}

void pending_add(struct pending *pending, int64_t time_ns, const char *series, const char *fields)
{
	add(pending, (struct head){.time_ns = time_ns}, series, fields);
}

void pending_add_dated(struct pending *pending, int64_t wall_ns, const char *series,
                       const char *fields)
{
	add(pending, (struct head){.time_ns = wall_ns, .dated = true}, series, fields);
}

size_t pending_copy(const struct pending *pending, int64_t offset_ns, size_t most,
                    char batch[BATCH_BYTES], unsigned *lines)
{
	size_t len = 0, at = 0;

	if (most > BATCH_BYTES)
		most = BATCH_BYTES;
	for (*lines = 0; at < pending->len && *lines < BATCH_LINES; ++*lines) {
		struct head head = head_at(pending, at);

		if (*lines && len + head.size + TIME_TEXT > most)
			break;
		at += sizeof(head);
		len += (size_t)snprintf(batch + len, head.size + TIME_TEXT, "%s %" PRId64 "\n",
		                        pending->data + at,
		                        head.time_ns + (head.dated ? 0 : offset_ns));
		at += head.size;
	}
	return len;
}

void pending_remove(struct pending *pending, uint64_t before)
{
	unsigned lines = 0;
	size_t at = 0;

	for (; at < pending->len && pending->first + lines < before; lines++)
		at += sizeof(struct head) + head_at(pending, at).size;
	remove_first(pending, at, lines);
}

bool pending_is_full(const struct pending *pending)
{
	return pending->lines >= BATCH_LINES || pending->len >= BATCH_BYTES / 2;
}
