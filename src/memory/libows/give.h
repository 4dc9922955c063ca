/* SPDX-License-Identifier: MIT */
/*
 * The memory in which a program commands (layout.h, "the memory of one controller"): mapped and
 * checked once. Only this program and owsd have it; a forked child that writes rubbish leads the
 * parent to no other place.
 */
#pragma once

#include <stdbool.h>

#include "src/memory/shm/word.h"
#include "src/public/ows_layout.h"

/* Do count entries of size bytes at off lie inside `room` bytes, in whole words? */
static inline bool area_inside(size_t room, uint32_t off, uint32_t count, uint32_t size)
{
	return off % 8 == 0 && off <= room && (uint64_t)count * size <= room - off;
}

struct give {
	char *base; /* NULL: none */
	/* as it began, checked, with the serial of the welcome; never read again */
	struct ows_controller_header header;
};

/* Map the memory that came with a welcome. Returns 0, or -EPROTO: it is not as promised. */
int give_map(int fd, const struct ows_welcome *welcome, struct give *give);
void give_unmap(struct give *give);
/* The room of a string signal's text; NULL: it has none. */
struct ows_command_text *give_text(const struct give *give, uint32_t record);
/* Store len bytes of text with its check word; len is at most text_cap. */
void give_store_text(struct ows_command_text *to, const char *text, size_t len);
/* Store a text and fill it up with NUL to size, a multiple of 4 and at most OWS_TEXT. */
void give_store_name(char *to, const char *text, size_t size);

static inline struct ows_controller_header *give_header(const struct give *give)
{
	return (void *)give->base;
}

static inline struct ows_command_slot *give_slot(const struct give *give, uint32_t record)
{
	return (void *)(give->base + give->header.slot_off +
	                (size_t)record * give->header.slot_size);
}

/*
 * The stamp of the record's last confirmed command; 0: none. One that seems newer than the last
 * set is older than that by 2^31 sets: it must reach no stamp that a program may wait for.
 */
static inline uint32_t give_applied(const struct give *give, uint32_t record)
{
	const struct ows_command_slot *slot = give->base ? give_slot(give, record) : NULL;
	uint32_t applied = slot ? word_get(&slot->applied) : 0;
	uint32_t stamp = slot ? word_get(&slot->stamp) : 0; /* 0: applied was carried over */

	return stamp && (int32_t)(applied - stamp) > 0 ? stamp - INT32_MAX : applied;
}

static inline struct ows_command_shelf *give_shelf(const struct give *give)
{
	return (void *)(give->base + give->header.shelf_off);
}

static inline char *give_person(const struct give *give, uint32_t person)
{
	return give->base + give->header.person_off + (size_t)person * OWS_NAME;
}

static inline uint32_t *give_dirty(const struct give *give, uint32_t record)
{
	return (uint32_t *)(void *)(give->base + give->header.dirty_off) + record / 32;
}

static inline void give_mark(const struct give *give, uint32_t record)
{
	__atomic_fetch_or(give_dirty(give, record), 1u << record % 32, __ATOMIC_RELEASE);
}

/* Does owsd look at this memory? Not if it was replaced, or owsd has ended. */
static inline bool give_is_live(const struct give *give)
{
	return word_get(&give_header(give)->state) == OWS_STATE_LIVE;
}
