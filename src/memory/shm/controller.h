/* SPDX-License-Identifier: MIT */
/*
 * The memory of one controller, owsd's side. owsd believes nothing that it finds there: indices and
 * offsets come from owsd's own layout, each word is read once, the caller checks values, the check
 * word checks texts. A controller that writes rubbish harms itself alone. No system calls. One
 * thread.
 */
#pragma once

#include <stdbool.h>

#include "src/public/ows_layout.h"

/* The layout of all memories of one generation. */
struct controller_layout {
	struct ows_controller_header header; /* as each memory begins, but for the serial */
	uint32_t *places; /* of each record among the texts; CONTROLLER_NO_TEXT: it is no string */
};
#define CONTROLLER_NO_TEXT UINT32_MAX

struct controller_plan {
	const uint8_t *types; /* of the signals: record i + 1 has types[i] */
	uint32_t signal_count;
	uint16_t text_cap; /* of every string signal, a multiple of 4 */
	uint32_t generation, start_id;
};
/* Allocates. 0, -ENOMEM, or -EFBIG: a memory would be larger than 2 GiB. */
int controller_layout_make(struct controller_layout *layout, const struct controller_plan *plan);
void controller_layout_free(struct controller_layout *layout);

struct controller_memory {
	char *base; /* layout->header.size bytes, aligned to 64 */
	const struct controller_layout *layout;
};
/* A controller as it joins; owsd copies it. */
struct joining_controller {
	struct controller_memory memory; /* built and LIVE */
	struct ows_who who;              /* serial, uid, pid, name (cleaned); person is empty */
	uint8_t token[16]; /* of its welcome: that of the hello, if it had one, else a new one */
	/* bit r: it may command record r (bit 0: reset the driver); NULL: all. Lives as long as
	   memory */
	const uint32_t *rights;
};

/* Lay out zeroed memory; its state is BUILDING after that. */
void controller_build(const struct controller_memory *memory, uint32_t serial);
/* For the controller to read; owsd keeps the rights of its own. */
void controller_allow(const struct controller_memory *memory, uint32_t record, bool allowed);
/* Sequentially consistent: a set that does not see RETIRED is seen by a look after this. */
void controller_state(const struct controller_memory *memory, enum ows_state state);

/* A slot as found. */
struct controller_command {
	int64_t value;
	uint32_t stamp;  /* 0: never commanded */
	bool fresh;      /* owsd has not looked at this stamp yet */
	uint32_t person; /* index + 1, checked; 0: for itself */
	/* what is new since the last look, which controller_load() notes in the slot */
	uint8_t read_enable, write_enable; /* 0 not new, 1 off, 2 on */
	bool one_shot, read_once, dgn_reset, acknowledged;
};
void controller_load(const struct controller_memory *memory, uint32_t record,
                     struct controller_command *command);
/*
 * Text of a string into text (size text_cap + 1). Returns the length, or -EBADMSG: length or check
 * word are wrong.
 */
int controller_text(const struct controller_memory *memory, uint32_t record, char *text);
/* A person's name: ended by NUL and filled up, its control characters are '?'. */
void controller_person(const struct controller_memory *memory, uint32_t person,
                       char name[OWS_NAME]);

/* The same for a name of any origin; from has OWS_NAME bytes. */
void controller_clean_name(char name[OWS_NAME], const char *from);

/* Is anything marked? Clears the mark; the look at the dirty bits comes after. */
bool controller_marked(const struct controller_memory *memory);
/* The same look without clearing, for the way to sleep, after image_awake(). */
bool controller_is_marked(const struct controller_memory *memory);
/* Returns the next record marked dirty at or after from, and clears its mark; -1: none. */
int controller_next_dirty(const struct controller_memory *memory, uint32_t from);

/* owsd's answers in a slot. */
void controller_taken(const struct controller_memory *memory, uint32_t record, uint32_t stamp,
                      int err);
void controller_applied(const struct controller_memory *memory, uint32_t record, uint32_t stamp);

/* The controller's words in the header, each read once. */
struct controller_beat {
	uint32_t beat, period_ms; /* period_ms 0: promised none */
	bool goodbye;
};
void controller_beat(const struct controller_memory *memory, struct controller_beat *beat);
/*
 * Does the controller wait for news? Clears the word: the caller rings the controller. The caller
 * has put a sequentially consistent fence between the count of news and this.
 */
bool controller_waits(const struct controller_memory *memory);

/* A request for shelving. */
struct controller_shelf {
	uint32_t count; /* 0: never asked */
	uint32_t record, seconds,
		person; /* record and person checked; record 0: it is out of range */
	char why[OWS_TEXT];
};
/* Returns whether there is a request that owsd has not acted on. */
bool controller_shelf(const struct controller_memory *memory, struct controller_shelf *shelf);
void controller_shelf_done(const struct controller_memory *memory, uint32_t count, int err);

/*
 * After a reload: the whole slots, texts, persons and controller's words of an old generation's
 * memory, which is RETIRED and was looked at for the last time. Record i + 1 gets what record
 * rows[i] + 1 had, nothing if rows[i] is 0xffffffff.
 */
void controller_copy(const struct controller_memory *to, const struct controller_memory *from,
                     const uint32_t *rows);
