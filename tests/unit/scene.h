/* SPDX-License-Identifier: MIT */
/*
 * A scene for engine tests: an engine with its image and commands on the heap, one bus that is
 * scripted, and a clock that only moves when the test says so. Everything that goes to the bus is
 * written down in a trace that a reader can follow.
 */
#ifndef UNIT_SCENE_H
#define UNIT_SCENE_H

#include "src/config/config.h"
#include "src/engine/engine.h"
#include "src/shm/commands.h"
#include "src/shm/image.h"

#define SCENE_MS 1000000LL
#define SCENE_S  1000000000LL
#define SCENE_ITEMS 64
#define SCENE_DEPTH 8

/* What the bus has at a path. */
struct scene_property {
	const char *path;
	char text[128];
	int err; /* not 0: answered instead */
	int write_err; /* likewise, to writes */
};

struct scene_pending {
	struct bus_req *req;
	int64_t when_ns;
};

struct scene {
	struct config config;
	struct config_item items[SCENE_ITEMS];
	struct config_target target;
	struct scene_property properties[SCENE_ITEMS * 2];
	unsigned property_count;

	struct engine *engine;
	struct engine_port port;
	struct image image;
	struct commands commands;
	struct command_plan command_plan;
	void *image_memory, *command_memory;
	int64_t now_ns;

	unsigned depth;          /* set before scene_start(); 1 */
	bool searches;           /* likewise */
	int64_t latency_ns;      /* of each answer; 1 ms */
	const char *slow;        /* but of this path: slow_ns */
	int64_t slow_ns;
	bool mute;               /* the bus answers nothing */
	bool refuses;            /* submit says -EAGAIN */
	struct scene_pending pending[SCENE_DEPTH];
	unsigned pending_count, most_pending;
	struct bus_req *swallowed[SCENE_DEPTH]; /* requests taken while mute */
	unsigned swallowed_count;

	char trace[16384];       /* "R /path\n" (r: fresh), "W /path=text\n" */
	unsigned reads, writes, structure_reads, lists;
	bool trace_lists;        /* "D /alarm" too */
	/* what else happens to the devices when something is read or written; may use scene_put() */
	void (*on_write)(struct scene *scene, const char *path, const char *data, uint32_t len);
	void (*on_read)(struct scene *scene, const char *path);
};

/* Fill in an item with the defaults of the file; the pointers must live. */
struct config_item *scene_input(struct scene *scene, const char *name, const char *path,
                                enum ows_type type);
struct config_item *scene_output(struct scene *scene, const char *name, const char *path,
                                 enum ows_type type);
/*
 * What the bus answers at path. err 0: text. Replaces. "/alarm" is the list of the devices in alarm,
 * each path ended by '\n'; without it the bus has no alarm search.
 */
void scene_put(struct scene *scene, const char *path, const char *text, int err);
/* Writes there fail with err, reads do not; 0: they do not any more. */
void scene_refuse_writes(struct scene *scene, const char *path, int err);
const char *scene_at(struct scene *scene, const char *path);

void scene_init(struct scene *scene);
/* Make memory and engine; the target is down until scene_up(). */
void scene_start(struct scene *scene);
/* The types are checked at once, in no time; the requests after that take theirs. */
void scene_up(struct scene *scene);
void scene_down(struct scene *scene, int err);
/* Let time pass: step the engine when it wants it, deliver answers when they are due. */
void scene_run(struct scene *scene, int64_t ns);
void scene_answer(struct scene *scene, uint32_t id, int err, const char *text, struct bus_req *req);
void scene_clear_trace(struct scene *scene);
void scene_end(struct scene *scene);

/* As a consumer does. record: 1 is the first item. */
void scene_set(struct scene *scene, unsigned record, int64_t value);
void scene_set_text(struct scene *scene, unsigned record, const char *text);
struct ows_command_slot *scene_slot(struct scene *scene, unsigned record);
void scene_ring(struct scene *scene, unsigned record);
struct ows_client *scene_client(struct scene *scene, unsigned client);

struct ows_sample scene_sample(struct scene *scene, unsigned record);
struct ows_attrs scene_attrs(struct scene *scene, unsigned record);
const char *scene_text(struct scene *scene, unsigned record);
double scene_number(struct scene *scene, unsigned record);
uint64_t scene_counter(struct scene *scene, const char *name);

#endif
