/* SPDX-License-Identifier: MIT */
/*
 * The command segment, owsd's side. owsd believes nothing it finds there: indices come from its own
 * table, values are checked by the caller, strings by their check word. No system call in this
 * file. One thread.
 */
#ifndef SHM_COMMANDS_H
#define SHM_COMMANDS_H

#include <stdbool.h>

#include "src/shm/layout.h"

struct command_signal {
	const char *name;
	const char *path;
	uint8_t type;
};
struct command_plan {
	const struct command_signal *signals; /* without slot 0 */
	uint32_t signal_count;
	uint16_t text_cap; /* of every string signal, multiple of 4 */
	uint32_t generation, start_id;
	int32_t pid;
};
struct commands {
	char *base;
	uint32_t size;
	/* owsd's own copy of what it needs to find its way: a consumer may overwrite the header */
	uint32_t slot_off, slot_count, entry_off, dirty_off, dirty_words, client_off, ack_off;
	uint32_t text_cap;
	uint32_t *text_off; /* for each slot, 0 if none; allocated by commands_build() */
	char *keep; /* copy of what does not change: the header's first half, entries, names */
	uint32_t keep_size;
};

size_t commands_size(const struct command_plan *plan);
/* Lay out in zeroed, 64-byte-aligned memory. Returns 0 or -ENOMEM. */
int commands_build(const struct command_plan *plan, void *memory, struct commands *commands);
void commands_forget(struct commands *commands); /* frees what commands_build() allocated */

/* One slot as found, copied in one go. */
struct command {
	int64_t value;
	uint32_t stamp;  /* 0: never commanded */
	uint32_t client; /* 0: nobody who beats; else index + 1, checked */
	bool safe;       /* commands_put_safe() has put it there, and nobody set it since */
	uint8_t read_enable, write_enable; /* 0 not commanded, 1 off, 2 on; checked */
	uint32_t one_shot, dgn_reset;
	uint32_t acknowledged; /* counts */
};
void commands_load(const struct commands *commands, uint32_t slot, struct command *command);
/*
 * Text of a string slot into text (size text_cap + 1). Returns the length, -EBUSY while a consumer
 * writes it, -EBADMSG when length or check word are wrong.
 */
int commands_text(const struct commands *commands, uint32_t slot, char *text);
/*
 * Put what was commanded in the segment before into a new one. text and len for strings, else NULL;
 * -EBUSY while a consumer writes the text. The stamp is the consumers'.
 */
int commands_put(struct commands *commands, uint32_t slot, int64_t value, const char *text,
                 uint32_t len);
/* The same with SafeValue, marked so that the next owsd knows it. */
int commands_put_safe(struct commands *commands, uint32_t slot, int64_t value, const char *text,
                      uint32_t len);
/* The stamp of a slot, in a segment that no consumer has seen yet. */
void commands_stamp(struct commands *commands, uint32_t slot, uint32_t stamp);
/* Free the claim of a writer that died in the middle; the engine calls it after a second. */
void commands_unclaim(struct commands *commands, uint32_t slot);

/* Next slot marked dirty at or after from, its mark taken away; -1: none. */
int commands_next_dirty(struct commands *commands, uint32_t from);

struct command_client {
	uint32_t pid, beat, period_ms;
};
void commands_client(const struct commands *commands, unsigned client, struct command_client *c);
/* Its place becomes free, and no command is its any more. */
void commands_drop_client(struct commands *commands, unsigned client);

uint32_t *commands_bell(const struct commands *commands);
void commands_awake(struct commands *commands, bool awake);
/* Sequentially consistent: a consumer that did not see RETIRED after its set was in time. */
void commands_state(struct commands *commands, enum ows_state state);
/* The same for a segment that an earlier owsd left, of which nothing is known but its size. */
void commands_retire(void *old, size_t old_size);

/*
 * Restore what only owsd may say there and a consumer overwrote: the header, or with all the
 * entries and names too. Returns whether something was. Once a period is right for the header;
 * all before an end, so that the next owsd can carry over.
 */
bool commands_mend(struct commands *commands, bool all);

#endif
