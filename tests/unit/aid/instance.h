/* SPDX-License-Identifier: MIT */
/*
 * An instance of owsd without owsd: makes the image under a name of this process and fills it by
 * the writer's functions as the engine does, and welcomes controllers (door.h).
 */
#pragma once

#include "src/memory/shm/image.h"
#include "src/memory/shm/segment.h"
#include "src/public/ows.h"
#include "tests/unit/aid/door.h"

#define INSTANCE_TEXT 64
#define INSTANCE_S INT64_C(1000000000)

struct instance_signal {
	const char *name, *path;
	uint8_t type;
	bool output;
	int64_t stale_after_ns;
	const char *device;   /* a ROM id, of no other signal; NULL: none */
	const char *identity; /* NULL: the path */
};

struct instance {
	char name[SEGMENT_NAME_MAX + 1];
	uint32_t generation;
	int64_t start_ns;
	struct segment image_memory;
	struct image image;
	struct door *door; /* from instance_show() on */
	const struct instance_signal *signals;
	uint32_t count;
	uint8_t detail; /* OWS_DETAIL_ bits of what is put */
};

/* Make the image, hidden: instance_show() puts it in place, makes it live, and opens the door. */
void instance_make(struct instance *in, const char *name, uint32_t generation, int64_t start_ns,
                   const struct instance_signal *signals, uint32_t count);
void instance_show(struct instance *in);
/* Make and show the image, at the present time, with a heart that beat just now. */
void instance_start(struct instance *in, const char *name, const struct instance_signal *signals,
                    uint32_t count);
/* Retire the image, make and show that of the next generation, and hand out its memories. */
void instance_reload(struct instance *in, const struct instance_signal *signals, uint32_t count);
/* Hang up on all controllers, as an owsd that is killed; the image stays. */
void instance_kill(struct instance *in);
/* Free the memory; the name of the image stays or is removed. */
void instance_leave(struct instance *in);
void instance_end(struct instance *in);

/* The memory of controller i of those who ever came, and its command for a record as found. */
struct controller_memory *instance_controller(struct instance *in, unsigned i);
struct controller_command instance_command(struct instance *in, unsigned i, uint32_t record);
/* Its slot itself, of which no look of the engine's side changes what the controller wrote. */
struct ows_command_slot *instance_slot(struct instance *in, unsigned i, uint32_t record);
/* How many controllers ever came. */
unsigned instance_controllers(struct instance *in);

void instance_beat(struct instance *in, int64_t now_ns, uint32_t period);
/*
 * A busy machine may hold up a test for longer than a heart may stand still: a reader that opens
 * the instance waits for INSTANCE_PATIENCE. It beats now, and does so from instance_start() on.
 */
#define INSTANCE_PATIENCE (45 * INSTANCE_S)
void instance_lives_on(struct instance *in);
/* For tests on a clock of their own: a reader that opens it from now on waits for two seconds. */
void instance_dies_soon(struct instance *in);
/* Publish a good value that was measured then. */
void instance_put(struct instance *in, uint32_t record, int64_t value, int64_t measured_ns);
void instance_put_double(struct instance *in, uint32_t record, double value, int64_t measured_ns);
void instance_put_text(struct instance *in, uint32_t record, const char *text, int64_t measured_ns);
