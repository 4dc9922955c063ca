/* SPDX-License-Identifier: MIT */
/*
 * The shared memory of an instance: both segments made from a configuration, what was commanded
 * carried over from the owsd before, and the hand-over to consumers. Blocking: file-system calls.
 */
#ifndef HOST_MEMORY_H
#define HOST_MEMORY_H

#include "src/config/config.h"
#include "src/shm/commands.h"
#include "src/shm/image.h"
#include "src/shm/segment.h"
#include "src/text/log.h"

struct memory {
	const char *instance;
	const struct config *config;
	struct segment image_segment;
	struct image image;
	/* the one in use, and those before it that a consumer took away */
	struct memory_commands {
		struct segment segment;
		struct commands commands;
	} commands[3];
	unsigned current;
	bool shown; /* consumers see the image */
	uint32_t generation, start_id;
	int64_t start_ns, start_wall_ns; /* of owsd; a reload is no start */
};

struct memory_setup {
	const char *instance;
	const struct config *config;
	const struct image_counter *counters; /* as in struct image_plan */
	uint32_t counter_count;
	struct log *log;
	const struct memory *before; /* a reload: what is in use; NULL: a start */
};
/*
 * Make both segments, not yet visible to consumers; the caller holds the instance's lock and
 * publishes the first values before memory_show(). At a start what was commanded of the owsd before
 * is carried over; at a reload that is the engine's work. Returns 0 or a negative errno, the reason
 * then stands in why.
 */
int memory_make(struct memory *memory, const struct memory_setup *setup, char *why,
                size_t why_size);
/*
 * Put them in place of those before, which are retired. 0 or a negative errno, the reason then
 * stands in why; may be called again then.
 */
int memory_show(struct memory *memory, struct log *log, char *why, size_t why_size);
/* The commands in use. */
struct commands *memory_commands(struct memory *memory);
/* Did a consumer truncate, remove or replace the command segment? A few system calls. */
bool memory_commands_lost(const struct memory *memory);
/*
 * Make a new, empty command segment, not yet visible to consumers, and return its commands; NULL
 * and *err if that fails. The one before is retired; its mapping stays until the call after the
 * next, so that others can let go of it.
 */
struct commands *memory_renew_commands(struct memory *memory, int *err);
/* Put the new command segment in its place, filled. 0 or a negative errno. */
int memory_show_commands(struct memory *memory);
/* Was the image removed or replaced, so that nobody can find it any more? Two system calls. */
bool memory_image_lost(const struct memory *memory);
/* After a reload: these segments have been replaced, and go without a word. */
void memory_replaced(struct memory *memory);
/*
 * Say that owsd ends, where memory was shown; it stays mapped for threads that do not end. May be
 * called again.
 */
void memory_stop(struct memory *memory);
/*
 * The same, and unmap: both segments stay, for the last values and for the next start. What was never
 * shown goes without a word, what was never made (all zero) is left alone. May be called again.
 */
void memory_end(struct memory *memory);

#endif
