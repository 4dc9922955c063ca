/* SPDX-License-Identifier: MIT */
/*
 * The command segment, owsd's side. owsd trusts nothing that it finds there: indices come from
 * owsd's own table, the caller checks values, the check word checks strings. No system calls. One
 * thread.
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
	/* owsd's own copy of offsets and counts: a consumer may overwrite those in the header */
	uint32_t slot_off, slot_count, entry_off, dirty_off, dirty_words, client_off, ack_off;
	uint32_t text_cap;
	uint32_t *text_off; /* for each slot, 0 if none; allocated by commands_build() */
	char *keep; /* copy of the constant parts: the header's first half, entries, names */
	uint32_t keep_size;
};

size_t commands_size(const struct command_plan *plan);
/* Lay out in zeroed, 64-byte-aligned memory. Returns 0 or -ENOMEM. */
int commands_build(const struct command_plan *plan, void *memory, struct commands *commands);
void commands_forget(struct commands *commands); /* frees what commands_build() allocated */

/* A slot as found, each word read once. */
struct command {
	int64_t value;
	uint32_t stamp;  /* 0: never commanded */
	uint32_t client; /* 0: no client that beats; else index + 1, checked */
	bool safe;       /* from commands_put_safe(), and not set by a consumer since */
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
 * Put a command of the previous segment into a new one. text and len for strings, else NULL;
 * -EBUSY while a consumer writes the text. Leaves the stamp alone, which only consumers count.
 */
int commands_put(struct commands *commands, uint32_t slot, int64_t value, const char *text,
                 uint32_t len);
/* The same with SafeValue, marked so that the next owsd recognises it. */
int commands_put_safe(struct commands *commands, uint32_t slot, int64_t value, const char *text,
                      uint32_t len);
/* Set the stamp of a slot, in a segment that no consumer has seen yet. */
void commands_stamp(struct commands *commands, uint32_t slot, uint32_t stamp);
/* Free the claim of a consumer that died while writing; the engine calls it after a second. */
void commands_unclaim(struct commands *commands, uint32_t slot);

/* Returns the next slot marked dirty at or after from, and clears its mark; -1: none. */
int commands_next_dirty(struct commands *commands, uint32_t from);

struct command_client {
	uint32_t pid, beat, period_ms;
};
void commands_client(const struct commands *commands, unsigned client, struct command_client *c);
/* Free the client's place, and forget in every slot that the client gave the command. */
void commands_drop_client(struct commands *commands, unsigned client);

uint32_t *commands_bell(const struct commands *commands);
void commands_awake(struct commands *commands, bool awake);
/* Sequentially consistent: the set of a consumer that does not see RETIRED after it was in time. */
void commands_state(struct commands *commands, enum ows_state state);
/* Retire a segment that an earlier owsd left, of which only the size is known. */
void commands_retire(void *old, size_t old_size);

/*
 * Restore the constant parts that a consumer overwrote: the header or, with all, the entries and
 * names too. Returns whether something was overwritten. owsd restores the header once a period, and
 * everything before it ends, so that the next owsd can carry the commands over.
 */
bool commands_repair(struct commands *commands, bool all);

#endif
