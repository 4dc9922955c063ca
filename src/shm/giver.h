/* SPDX-License-Identifier: MIT */
/*
 * The memory of one giver, owsd's side. owsd believes nothing that it finds there: indices and
 * offsets come from owsd's own layout, each word is read once, the caller checks values, the check
 * word checks texts. A giver that writes rubbish harms itself alone. No system calls. One thread.
 */
#ifndef SHM_GIVER_H
#define SHM_GIVER_H

#include <stdbool.h>

#include "src/shm/layout.h"

/* The layout of all memories of one generation. */
struct giver_layout {
	uint32_t size; /* bytes of a memory */
	uint32_t generation, start_id;
	uint32_t slot_off, slot_count; /* one slot for each record, record 0 included */
	uint32_t text_off, text_cap, place_off;
	uint32_t dirty_off, dirty_words;
	uint32_t person_off, shelf_off;
	uint32_t *places; /* of each record among the texts; GIVER_NO_TEXT: it is no string */
};
#define GIVER_NO_TEXT UINT32_MAX

struct giver_plan {
	const uint8_t *types; /* of the signals: record i + 1 has types[i] */
	uint32_t signal_count;
	uint16_t text_cap; /* of every string signal, a multiple of 4 */
	uint32_t generation, start_id;
};
/* Allocates. 0, -ENOMEM, or -EFBIG: a memory would be larger than 2 GiB. */
int giver_layout_make(struct giver_layout *layout, const struct giver_plan *plan);
void giver_layout_free(struct giver_layout *layout);

struct giver_memory {
	char *base; /* layout->size bytes, aligned to 64 */
	const struct giver_layout *layout;
};
/* Lay out zeroed memory; its state is BUILDING after that. */
void giver_build(const struct giver_memory *memory, uint32_t serial);
/* For the giver to read; owsd keeps the rights of its own. */
void giver_allow(const struct giver_memory *memory, uint32_t record, bool allowed);
/* Sequentially consistent: a set that does not see RETIRED is seen by a look after this. */
void giver_state(const struct giver_memory *memory, enum ows_state state);

/* A slot as found. */
struct giver_command {
	int64_t value;
	uint32_t stamp;  /* 0: never commanded */
	bool fresh;      /* owsd has not looked at this stamp yet */
	uint32_t person; /* index + 1, checked; 0: for itself */
	/* what is new since the last look, which giver_load() notes in the slot */
	uint8_t read_enable, write_enable; /* 0 not new, 1 off, 2 on */
	bool one_shot, dgn_reset, acknowledged;
};
void giver_load(const struct giver_memory *memory, uint32_t record, struct giver_command *command);
/*
 * Text of a string into text (size text_cap + 1). Returns the length, or -EBADMSG: length or check
 * word are wrong.
 */
int giver_text(const struct giver_memory *memory, uint32_t record, char *text);
/* A person's name: ended by NUL and filled up, its control characters are '?'. */
void giver_person(const struct giver_memory *memory, uint32_t person, char name[OWS_NAME]);

/* The same for a name of any origin; from has OWS_NAME bytes. */
void giver_clean_name(char name[OWS_NAME], const char *from);

/* Is anything marked? Clears the mark; the look at the dirty bits comes after. */
bool giver_marked(const struct giver_memory *memory);
/* The same look without clearing, for the way to sleep, after image_awake(). */
bool giver_is_marked(const struct giver_memory *memory);
/* Returns the next record marked dirty at or after from, and clears its mark; -1: none. */
int giver_next_dirty(const struct giver_memory *memory, uint32_t from);

/* owsd's answers in a slot. */
void giver_taken(const struct giver_memory *memory, uint32_t record, uint32_t stamp, int err);
void giver_applied(const struct giver_memory *memory, uint32_t record, uint32_t stamp);

/* The giver's words in the header, each read once. */
struct giver_beat {
	uint32_t beat, period_ms; /* period_ms 0: promised none */
	bool goodbye;
};
void giver_beat(const struct giver_memory *memory, struct giver_beat *beat);
/*
 * Does the giver wait for news? Clears the word: the caller rings the giver. The caller has put a
 * sequentially consistent fence between the count of news and this.
 */
bool giver_waits(const struct giver_memory *memory);

/* A request for shelving. */
struct giver_shelf {
	uint32_t count; /* 0: never asked */
	uint32_t record, seconds,
		person; /* record and person checked; record 0: it is out of range */
	char why[OWS_TEXT];
};
/* Returns whether there is a request that owsd has not acted on. */
bool giver_shelf(const struct giver_memory *memory, struct giver_shelf *shelf);
void giver_shelf_done(const struct giver_memory *memory, uint32_t count, int err);

/*
 * After a reload: the whole slots, texts, persons and giver's words of an old generation's memory,
 * which is RETIRED and was looked at for the last time. Record i + 1 gets what record rows[i] + 1
 * had, nothing if rows[i] is 0xffffffff.
 */
void giver_copy(const struct giver_memory *to, const struct giver_memory *from,
                const uint32_t *rows);

#endif
