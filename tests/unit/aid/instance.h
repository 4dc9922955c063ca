/* SPDX-License-Identifier: MIT */
/*
 * An instance of owsd without owsd: makes both segments under a name of this process, and fills
 * them by the writer's functions as the engine does.
 */
#ifndef TESTS_UNIT_AID_INSTANCE_H
#define TESTS_UNIT_AID_INSTANCE_H

#include "src/libows/ows.h"
#include "src/shm/commands.h"
#include "src/shm/image.h"
#include "src/shm/segment.h"

#define INSTANCE_TEXT 64
#define INSTANCE_S INT64_C(1000000000)

struct instance_signal {
	const char *name, *path;
	uint8_t type;
	bool output;
	int64_t stale_after_ns;
};

struct instance {
	char name[SEGMENT_NAME_MAX + 1];
	uint32_t generation;
	int64_t start_ns;
	struct segment image_memory, command_memory;
	struct image image;
	struct commands commands;
	const struct instance_signal *signals;
	uint32_t count;
};

/* Make both segments, hidden: instance_show() puts them in place and makes them live. */
void instance_make(struct instance *in, const char *name, uint32_t generation, int64_t start_ns,
                   const struct instance_signal *signals, uint32_t count);
void instance_show(struct instance *in);
/* Make and show both segments, at the present time, with a heart that beat just now. */
void instance_start(struct instance *in, const char *name, const struct instance_signal *signals,
                    uint32_t count);
/* Retire both segments, make and show those of the next generation, and carry the commands over. */
void instance_reload(struct instance *in, const struct instance_signal *signals, uint32_t count);
/* Free the memory; the names stay or are removed. */
void instance_leave(struct instance *in);
void instance_end(struct instance *in);

void instance_beat(struct instance *in, int64_t now_ns, uint32_t period);
/*
 * For tests on the real clock: a busy machine may hold up a test for longer than a heart may stand
 * still. A reader that opens the instance from now on waits for INSTANCE_PATIENCE.
 */
#define INSTANCE_PATIENCE (45 * INSTANCE_S)
void instance_lives_on(struct instance *in);
/* Publish a good value that was measured then. */
void instance_put(struct instance *in, uint32_t record, int64_t value, int64_t measured_ns);
void instance_put_double(struct instance *in, uint32_t record, double value, int64_t measured_ns);
void instance_put_text(struct instance *in, uint32_t record, const char *text, int64_t measured_ns);

#endif
