/* SPDX-License-Identifier: MIT */
/*
 * The files of an instance that belong to a configuration: the image for the consumers, NAME.force
 * for the next owsd; and the layout of the controllers' memories. Blocking: file-system calls.
 */
#pragma once

#include "src/config/read/config.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/controller.h"
#include "src/memory/shm/force.h"
#include "src/memory/shm/image.h"
#include "src/memory/shm/segment.h"

struct porter;

struct memory {
	const char *instance;
	const struct shm_dir *dir;
	const struct config *config;
	struct porter *porter;
	struct segment image_segment;
	struct image image;
	struct segment force_segment;
	struct force force;
	struct controller_layout layout;
	/* until memory_resumed(): what the owsd before has left */
	struct segment left_segment;
	struct force_left left;
	bool has_left;
	bool shown; /* consumers see the image */
	uint32_t generation, start_id;
	int64_t start_ns, start_wall_ns; /* of owsd; a reload is no start */
};

struct memory_setup {
	const char *instance;
	const struct shm_dir *dir;
	const struct config *config;
	const struct image_counter *counters; /* as in struct image_plan */
	uint32_t counter_count;
	struct log *log;
	struct porter *porter;       /* wakes the programs that sleep on an image that ends */
	const struct memory *before; /* a reload: what is in use; NULL: a start */
};
/*
 * Make the files, not yet visible to consumers; the caller holds the instance's lock and publishes
 * the first values before memory_show(). Returns 0, or a negative errno with the reason in why.
 */
int memory_make(struct memory *memory, const struct memory_setup *setup, char *why,
                size_t why_size);
/* The engine knows what the owsd before has left. */
void memory_resumed(struct memory *memory);
/*
 * Put the files in place of those before, and retire the image before. Returns 0, or a negative
 * errno with the reason in why; then the caller may call it again.
 */
int memory_show(struct memory *memory, struct log *log, char *why, size_t why_size);
/* Was the image removed or replaced, so that no program can find it any more? Two system calls. */
bool memory_image_lost(const struct memory *memory);
/*
 * After a reload: unmap these files, which the new ones have replaced; consumers know already.
 */
void memory_replaced(struct memory *memory);
/*
 * Mark in the image that owsd ends; it stays mapped for threads that do not end. May be called
 * again.
 */
void memory_stop(struct memory *memory);
/*
 * The same, and unmap: the files stay, for the last values and for the next start. Files that were
 * never shown are removed; memory that was never made (all zero) is left alone. May be called
 * again.
 */
void memory_end(struct memory *memory);
