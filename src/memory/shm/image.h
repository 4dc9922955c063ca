/* SPDX-License-Identifier: MIT */
/*
 * The image, writer's side: build it in memory, publish into it. No function here makes a system
 * call: src/memory/shm/segment.h makes the memory, tests use the heap. One thread.
 */
#pragma once

#include <stdbool.h>

#include "src/public/ows_layout.h"

/* What people say of a signal: it describes, and changes nothing. */
struct image_meta {
	const char *unit, *description, *family, *device, *calibrated, *points; /* NULL: none */
	const char *group;                                                      /* likewise */
	uint32_t decimals;    /* UINT32_MAX: not known */
	double scale, offset; /* 1 and 0 without */
	double min, max;      /* NAN: not set, like the limits */
	double limit_hh, limit_h, limit_l, limit_ll;
	double filter_s, deadband; /* 0 without */
};
extern const struct image_meta image_no_meta;

/* What the image of a configuration contains; strings are copied. */
struct image_signal {
	const char *name;
	const char *path;
	uint8_t type;
	uint8_t flags;     /* OWS_RECORD_ bits */
	uint16_t text_cap; /* strings */
	uint32_t per_factor;
	uint32_t line;
	int64_t stale_after_ns;
	bool has_init, has_safe;
	int64_t init_value, safe_value;
	bool starts_last; /* Start "last" */
	bool confirm;
	const struct image_meta *meta; /* NULL: image_no_meta */
	const char *identity;          /* NULL: the path */
};
struct image_counter {
	const char *name;
	uint32_t target; /* 0xffffffff: owsd */
};
struct image_plan {
	const struct image_signal *signals; /* without record 0 */
	uint32_t signal_count;
	const char *const *targets;
	uint32_t target_count;
	const uint32_t *groups; /* of the targets; NULL: each is a wire of its own */
	const struct image_counter *counters;
	uint32_t counter_count;
	const uint32_t *devices; /* of each device its first signal, an index of signals */
	uint32_t device_count;
	uint32_t log_lines;
	const char *served; /* the target that reaches the served protocol; NULL: none */
	uint32_t generation, start_id;
	int32_t pid;
	int64_t start_ns, start_wall_ns, period_ns;
};

/*
 * The areas of an image: kind, the type of an entry, the member of struct image, and how many
 * entries a plan has (image.c; `records` counts the signals and record 0).
 */
#define IMAGE_AREAS(X) \
	X(RECORDS, struct ows_record, records, records) /* [0] is owsd */ \
	X(INFOS, struct ows_info_entry, infos, records) \
	X(NAMES, struct ows_name_entry, names, records) \
	X(TARGETS, struct ows_target_entry, targets, plan->target_count) \
	X(COUNTERS, struct ows_counter_entry, counters, plan->counter_count) \
	X(POOL, char, pool, pool_bytes(plan)) \
	X(TEXTS, char, texts, text_bytes(plan)) \
	X(ORIGINS, struct ows_origin_entry, origins, records) \
	X(CONTROLLERS, struct ows_controller_entry, controllers, OWS_CONTROLLERS) \
	X(SHELVES, struct ows_shelf_entry, shelves, OWS_SHELVES) \
	X(ALARMS, struct ows_journal_entry, alarms, OWS_JOURNAL) /* the journals */ \
	X(COMMANDS, struct ows_journal_entry, commands, OWS_JOURNAL) \
	X(CHANGES, struct ows_change_entry, changes, changes_of(records)) \
	X(DEVICES, struct ows_device_entry, devices, plan->device_count) \
	X(LOG, struct ows_log_entry, log, plan->log_lines) \
	X(REFUSED, struct ows_log_entry, refused, plan->log_lines != 0) \
	X(NOTES, struct ows_log_entry, notes, plan->log_lines ? plan->target_count : 0)

/* A built image: pointers into its memory, and how many entries there are. */
struct image {
	struct ows_image_header *header;
	struct ows_area_entry *areas;              /* the area of a kind is [kind - 1] */
#define X(kind, type, member, count) type *member; /* NULL: it has no entries */
	IMAGE_AREAS(X)
#undef X
	uint32_t record_count, target_count, counter_count, change_count, device_count, log_lines;
	char *base;
};

/* Bytes an image of this plan needs; 0 if that is more than 2 GiB. */
size_t image_size(const struct image_plan *plan);
/* Lay the plan out in zeroed, 64-byte-aligned memory of that size; state is BUILDING after it. */
void image_build(const struct image_plan *plan, void *memory, struct image *image);

/*
 * Publish a new state of a record: both parts, and for strings len bytes of text. Computes the
 * check words. Bounded, wait-free.
 */
void image_publish(struct image *image, uint32_t record, const struct ows_sample *sample,
                   const struct ows_attrs *attrs, const char *text);
/* Enter a record into the ring of changes, after what was published of it. */
void image_change(struct image *image, uint32_t record);
void image_target(struct image *image, uint32_t target, uint32_t state, uint32_t reconnects);
void image_moves(struct image *image, uint32_t target, uint32_t moves);
void image_counter(struct image *image, uint32_t counter, uint64_t total);
/* Count the news word up; the caller wakes sleepers (segment_wake) when it has published enough. */
void image_news(struct image *image);
/*
 * Whether the engine looks for commands before it sleeps. Sequentially consistent: a controller
 * that saw the old word and rang no bell had marked its command before; the look that follows finds
 * it.
 */
void image_awake(struct image *image, bool awake);
/* Set the state of the image; counts the news word up too. */
void image_state(struct image *image, enum ows_state state);
/* Retire an image that an earlier owsd left, of which only the size is known. */
void image_retire(void *old, size_t old_size);
