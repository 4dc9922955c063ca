/* SPDX-License-Identifier: MIT */
/*
 * A scene for engine tests: an engine with its image and its controllers on the heap, buses that
 * are scripted, and a clock that only moves when the test says so. Everything that goes to a bus is
 * written down in a trace that a reader can follow.
 *
 * Most tests have one bus, and speak of it as the scene. Several are made by scene_bus(): each is a
 * target on a wire, and those on the same wire are ways to it (a bar).
 */
#pragma once

#include "src/config/read/config.h"
#include "src/daemon/engine/command/controllers.h"
#include "src/daemon/engine/command/last.h"
#include "src/daemon/engine/engine.h"
#include "src/memory/shm/force.h"
#include "src/memory/shm/image.h"
#include "tests/unit/aid/giving.h"

#define SCENE_MS 1000000LL
#define SCENE_S 1000000000LL
#define SCENE_ITEMS 64
#define SCENE_DEPTH 8
#define SCENE_BUSES 4
#define SCENE_NOWHERE 99
#define SCENE_CONTROLLERS 4

/* A property on a wire. */
struct scene_property {
	const char *path;
	unsigned wire;
	char text[128];
	int err;       /* not 0: the error of reads */
	int write_err; /* not 0: the error of writes */
};

struct scene_pending {
	struct bus_req *req;
	int64_t when_ns;
};

struct scene_bus {
	struct scene *scene;
	const char *name;
	unsigned port; /* the engine's number of the bus */
	unsigned wire;
	unsigned depth;            /* 1 unless set before scene_start() */
	uint8_t detail;            /* sent with its answers */
	struct bus_answer besides; /* retries, supply, identity and wire_us of its answers */
	bool searches;             /* the bus searches for devices */
	bool brief;                /* what fails is asked again soon */
	bool holds;                /* the bus has hardware, which it can give back */
	int64_t latency_ns;        /* the time of each answer; 1 ms unless set */
	const char *slow;          /* answers for this path take slow_ns */
	int64_t slow_ns;
	bool mute;     /* the bus answers nothing */
	bool refuses;  /* submit returns -EAGAIN */
	int probe_err; /* not 0: the error of looks for devices */
	struct scene_pending pending[SCENE_DEPTH];
	unsigned pending_count, most_pending;
	struct bus_req *swallowed[SCENE_DEPTH]; /* requests taken while mute */
	unsigned swallowed_count;
	unsigned reads, writes, lists, probes;

	/* of a bus that holds hardware */
	bool there;         /* scene_reach(): its target can be reached; reported when it opens */
	bool released;      /* the bus has given the hardware back, or never opened it */
	bool asked, wanted; /* asked, and not done yet: to open (wanted) or to give back */
	int64_t asked_ns;
	int64_t turn_ns; /* the time that this takes; 1 ms unless set */
	int64_t when_ns; /* when it is done; INT64_MAX: nothing was asked */
	unsigned opened;
};

/* What belongs to one engine. */
struct scene_part {
	struct config config;
	struct config_item items[SCENE_ITEMS];
	struct config_target targets[SCENE_BUSES];
	struct engine_port ports[SCENE_BUSES];
	struct image image;
};

/* The disk of Start "last". */
struct scene_disk {
	bool full;  /* nothing is stored */
	bool waits; /* nothing is stored until scene_store() */
	uint32_t tickets, stored;
	struct scene_stored {
		const char *name;
		bool known;
		int64_t value;
		char text[128];
		uint32_t len;
	} rows[SCENE_ITEMS];
	struct engine_last seam;
};

struct scene {
	struct config config;
	struct config_item items[SCENE_ITEMS];
	struct config_target targets[SCENE_BUSES];
	struct scene_property properties[SCENE_ITEMS * 2];
	unsigned property_count;

	struct engine *engine;
	struct engine_port ports[SCENE_BUSES];
	struct scene_part *part; /* the parts of a reload's engine; NULL: those of this struct */
	struct scene_bus bus[SCENE_BUSES];
	unsigned bus_count;
	struct log *log;                    /* NULL unless set before scene_start() */
	const struct engine_guests *guests; /* NULL unless set before scene_start() */
	struct image image;
	void *image_memory, *force_memory;
	size_t force_size;
	struct force *force;                          /* of the engine, on the heap */
	struct controller_layout *layout;             /* of the controllers, on the heap */
	struct giving controllers[SCENE_CONTROLLERS]; /* by their seats */
	uint32_t tokens[SCENE_CONTROLLERS];
	uint32_t serials;
	uint32_t rights[SCENE_CONTROLLERS][SCENE_ITEMS / 32 + 1];
	bool limited; /* scene_allow() was called: rights count */
	bool dropped; /* at a reload there is no room for the memory of seat 1 */
	uint32_t uid; /* of controllers that join; 1000 unless set */
	struct scene_disk disk;
	int64_t now_ns;

	char trace[16384]; /* "R /path\n" (r: fresh), "W /path=text\n"; "1: " before bus 1's */
	bool no_trace;
	unsigned reads, writes, lists;
	bool trace_lists; /* the trace has "D /alarm" too; "d /alarm": with each id whole */
	/* called at a read or write, for what else happens to the devices; may use scene_put() */
	void (*on_write)(struct scene *scene, const char *path, const char *data, uint32_t len);
	void (*on_read)(struct scene *scene, const char *path);
	/* called at the end of a request, with the bus that did it */
	void (*on_done)(struct scene_bus *bus, const struct bus_req *req);
};

/* Fill in an item with the defaults of the file; the texts have to stay. */
struct config_item *scene_input(struct scene *scene, const char *name, const char *path,
                                enum ows_type type);
struct config_item *scene_output(struct scene *scene, const char *name, const char *path,
                                 enum ows_type type);
/*
 * What the bus answers at path. err 0: text. Replaces. "/alarm" is the list of the devices in
 * alarm, each path ended by '\n'; without it the bus has no alarm search.
 */
void scene_put(struct scene *scene, const char *path, const char *text, int err);
/* Writes to path fail with err, reads do not; 0: writes succeed again. */
void scene_refuse_writes(struct scene *scene, const char *path, int err);
const char *scene_at(struct scene *scene, const char *path);

void scene_init(struct scene *scene);
/* Add a target on that wire; wires are numbered in the order of their first targets. */
struct scene_bus *scene_bus(struct scene *scene, const char *name, unsigned wire);
/* As scene_put(), on another wire than the first. */
void scene_put_on(struct scene *scene, unsigned wire, const char *path, const char *text, int err);
/* Move all properties below path, as "/28.551DDF030000", to another wire, or to SCENE_NOWHERE. */
void scene_plug(struct scene *scene, const char *path, unsigned wire);
/* All properties below path answer "no such device", or as before. */
void scene_unplug(struct scene *scene, const char *path, bool unplug);
/* The target of a bus that holds hardware can be reached or not; the bus reports what follows. */
void scene_reach(struct scene *scene, unsigned bus, bool there);
/* Report a device: BUS_FOUND, BUS_LOST, BUS_POR. */
void scene_tell(struct scene *scene, unsigned bus, enum bus_news news, const char *path);
/* Make memory and engine; the target is down until scene_up(). */
void scene_start(struct scene *scene);
/*
 * A reload: change() edits items, targets (by the names of buses, their count and order as it
 * likes) and the rest of the configuration; NULL: it is as it was. What the buses have is left as
 * it is, and the trace goes on.
 */
void scene_reload(struct scene *scene, void (*change)(struct config *));
/*
 * Start another owsd with the same configuration, after this one was killed. No controller is
 * connected, the target is down, and the trace is empty. Not after scene_reload().
 */
void scene_restart(struct scene *scene);
/* The same after the machine has started: only the disk is left. */
void scene_reboot(struct scene *scene);
/* What was put is on the disk. */
void scene_store(struct scene *scene);
/* Take the target up. The types are checked in no time; later requests take theirs. */
void scene_up(struct scene *scene);
void scene_down(struct scene *scene, int err);
void scene_up_on(struct scene *scene, unsigned bus);
void scene_down_on(struct scene *scene, unsigned bus, int err);
/* Let time pass: step the engine when it is due, deliver answers when they are due. */
void scene_run(struct scene *scene, int64_t ns);
void scene_answer(struct scene *scene, uint32_t id, int err, const char *text, struct bus_req *req);
void scene_answer_on(struct scene *scene, unsigned bus, uint32_t id, int err, const char *text,
                     struct bus_req *req);
void scene_clear_trace(struct scene *scene);
void scene_end(struct scene *scene);

/*
 * The controller at seat 0 is there from scene_start() on; it promises no beat. record: 1 is the
 * first item.
 */
void scene_set(struct scene *scene, unsigned record, int64_t value);
void scene_set_text(struct scene *scene, unsigned record, const char *text);
struct ows_command_slot *scene_slot(struct scene *scene, unsigned record);
void scene_ring(struct scene *scene, unsigned record);
/* Set _ReadEnable and _WriteEnable. */
void scene_enable_reads(struct scene *scene, unsigned record, bool on);
void scene_enable_writes(struct scene *scene, unsigned record, bool on);
/* The stamp of the last command that was applied, as this controller gets to know it. */
uint32_t scene_applied(struct scene *scene, unsigned record);

/* A controller takes a seat; with the token of one that was there before it comes back as that
 * one. */
void scene_join(struct scene *scene, unsigned seat, uint32_t token);
/* Before scene_join(): the controller of this seat may command this record, and those named so
 * far. */
void scene_allow(struct scene *scene, unsigned seat, unsigned record);
/* The controller of the seat hangs up, or is dead: with its last command taken. */
void scene_leave(struct scene *scene, unsigned seat);
/* The same with a goodbye. */
void scene_goodbye(struct scene *scene, unsigned seat);
void scene_set_by(struct scene *scene, unsigned seat, unsigned record, int64_t value);
/* Let time pass in which the controllers of the first n seats beat. */
void scene_beat(struct scene *scene, unsigned n, uint32_t period_ms, int64_t ns);

struct ows_origin_entry scene_origin(struct scene *scene, unsigned record);

struct ows_sample scene_sample(struct scene *scene, unsigned record);
/* Check the signal's quality and the target that it comes from. */
void scene_expect(struct scene *scene, unsigned record, uint8_t quality, unsigned target);
struct ows_attrs scene_attrs(struct scene *scene, unsigned record);
/* As the image shows a device, in the order of the ROM ids. */
struct ows_device_entry scene_device(struct scene *scene, unsigned index);
const char *scene_text(struct scene *scene, unsigned record);
double scene_number(struct scene *scene, unsigned record);
uint64_t scene_counter(struct scene *scene, const char *name);
/* A counter of a lane. */
uint64_t scene_counter_of(struct scene *scene, unsigned bus, const char *name);
uint32_t scene_target_state(struct scene *scene, unsigned bus);
