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
	/* the segment in use, and those before it that consumers removed or truncated */
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
 * publishes the first values before memory_show(). A start carries the commands over that consumers
 * gave to the previous owsd; at a reload the engine does it. Returns 0, or a negative errno with
 * the reason in why.
 */
int memory_make(struct memory *memory, const struct memory_setup *setup, char *why,
                size_t why_size);
/*
 * Put both segments in place of the segments before, and retire those. Returns 0, or a negative
 * errno with the reason in why; then the caller may call it again.
 */
int memory_show(struct memory *memory, struct log *log, char *why, size_t why_size);
/* The commands in use. */
struct commands *memory_commands(struct memory *memory);
/* Did a consumer truncate, remove or replace the command segment? A few system calls. */
bool memory_commands_lost(const struct memory *memory);
/*
 * Make a new, empty command segment, not yet visible to consumers, and return its commands; NULL
 * and *err if that fails. The segment before is retired; its mapping stays until the call after the
 * next, so that other threads can finish with it.
 */
struct commands *memory_renew_commands(struct memory *memory, int *err);
/* Show consumers the new command segment, which the engine has filled. 0 or a negative errno. */
int memory_show_commands(struct memory *memory);
/* Was the image removed or replaced, so that no program can find it any more? Two system calls. */
bool memory_image_lost(const struct memory *memory);
/*
 * After a reload: unmap these segments, which the new ones have replaced; consumers know already.
 */
void memory_replaced(struct memory *memory);
/*
 * Mark in shown segments that owsd ends; they stay mapped for threads that do not end. May be
 * called again.
 */
void memory_stop(struct memory *memory);
/*
 * The same, and unmap: the files of both segments stay, for the last values and for the next start.
 * Segments that were never shown are removed; memory that was never made (all zero) is left alone.
 * May be called again.
 */
void memory_end(struct memory *memory);

#endif
