/* SPDX-License-Identifier: MIT */
/*
 * The signal table: one row for each item of the file, in its order, with everything the engine
 * knows of the signal. Allocated once. Row r is record r + 1 of the image.
 */
#ifndef ENGINE_TABLE_H
#define ENGINE_TABLE_H

#include "src/config/config.h"
#include "src/engine/guard.h"
#include "src/engine/limit.h"
#include "src/engine/retry.h"
#include "src/shm/image.h"
#include "src/signal/quantity.h"
#include "src/signal/value.h"
#include "src/text/log.h"

/* Room for the text of a string signal in the layout, bytes; a multiple of 4. */
#define TABLE_TEXT_CAP VALUE_STRING_MAX

#define TABLE_NO_DEVICE UINT32_MAX

/*
 * A reload carries over what stands in sample, attrs and in the structures of a signal that have a
 * name, each of them whole (adopt_signal.c). What stands beside them is of one engine: the place in
 * its table, and what its buses have.
 */

/* How reading goes. */
struct signal_reading {
	int64_t known_ns; /* since when the signal is in the table */
	int64_t updated_ns;
	struct retry retry;
	struct guard guard;
	/* quality and error as they stood when the target was lost, if held */
	bool held;
	uint8_t held_quality;
	int32_t held_err;
};

/* What was last seen in the command segment. */
struct signal_seen {
	uint32_t stamp, one_shots, dgn_resets, acknowledged;
	uint32_t client; /* index + 1 of the control program that beats; 0: none */
	bool awaited;    /* the command is of before the start: not written until client beats */
};

/* What is to be written, what was written, and how writing goes. */
struct signal_command {
	bool given;     /* there is something to write: by a program, or InitValue */
	bool confirmed; /* written is what the bus has */
	bool agrees;    /* it was read back as it was written */
	bool one_shot;  /* write once more, changed or not */
	bool forced;    /* a write in doubt ended late: the present value goes out again */
	bool safe;      /* put to SafeValue, its client stopped beating */
	int err;        /* of the last write, until one succeeds or writing is disabled */
	int64_t value, written;
	uint32_t stamp;            /* of value; seen.stamp may be that of a refused one */
	uint32_t len, written_len; /* strings: of command_text, written_text */
	struct retry retry;
};

/* The limit alarms, and what the journal and the log have of them. */
struct signal_limit {
	struct limit alarm;
	struct log_rate log;
	bool logged;      /* the log has the raised alarm, and gets its return too */
	int64_t value[2]; /* of the update before the last, of the last */
	uint32_t count;   /* sample.count of the last */
	uint8_t values;   /* how many of the two are known */
};

struct signal {
	const struct config_item *item;
	uint32_t record;
	uint32_t device; /* row of table.devices, or TABLE_NO_DEVICE */
	unsigned lane;   /* which serves it */
	bool measured;   /* quantity says what it can be */
	struct quantity quantity;

	bool reading, writing; /* a request of the lane is with the bus */
	bool alarming;         /* a request of the alarm machine counts for it */
	uint16_t doubts; /* writes that may still reach it over other targets: it is not written */
	int alarm_err;   /* why its alarm cannot be armed, if OWS_ATTR_ALARM_UNARMED */

	struct ows_sample sample; /* as published */
	struct ows_attrs attrs;
	struct signal_reading read;
	struct signal_seen seen;
	struct signal_command command;
	struct signal_limit limit;
	/* strings, TABLE_TEXT_CAP bytes each: published, to be written, written */
	char *text, *command_text, *written_text;
};

struct device {
	uint8_t rom[8];
	bool has_rom;          /* false: an alias */
	bool absent;           /* a signal of it went bad with "no such device" */
	uint32_t first, count; /* rows in table.device_rows */

	/* where it is served, and looked for (place.c, routing.c) */
	unsigned group;
	int64_t moved_ns;
	bool probing;    /* queued or with a bus */
	unsigned probed; /* the last group it was looked for on */
	unsigned probe_doublings;
	int64_t probe_ns; /* not before; 0: it need not be looked for */
};

struct table {
	struct signal *signals;
	uint32_t count;
	struct device *devices; /* one more than device_count: the rows without a device */
	uint32_t device_count, rom_count; /* those with a ROM id stand first, in its order */
	uint32_t *device_rows;
	char *texts;
};

/* Makes a row of each item; nothing is due yet. 0 or -ENOMEM. */
int signal_table_init(struct table *table, const struct config *config);
void signal_table_free(struct table *table);

/* The device with this ROM id, TABLE_NO_DEVICE: no row is of it. */
uint32_t table_device(const struct table *table, const uint8_t rom[8]);

/* What the image and the command segment of this configuration contain. */
void signal_table_image(const struct config_item *item, struct image_signal *signal);

static inline bool signal_is_string(const struct signal *s)
{
	return s->item->type == OWS_STRING;
}
static inline bool signal_reads(const struct signal *s)
{
	return s->attrs.flags & OWS_ATTR_READ_ENABLE;
}
static inline bool signal_writes(const struct signal *s)
{
	return s->attrs.flags & OWS_ATTR_WRITE_ENABLE;
}
/* Does its commanded value have to go out? */
bool signal_changed(const struct signal *s);
/* Is the last command what the bus has? Then it is confirmed. */
void signal_settle(struct signal *s);

/* A request of this signal begins, ends; an update (value read or written) was made. */
void signal_begin(struct signal *s, uint64_t period);
void signal_end(struct signal *s, uint64_t period, uint64_t begun);
void signal_update(struct signal *s, uint64_t period, int64_t measured_ns, int64_t now_ns);
/* The edge of _DGNRESET. */
void signal_reset_diagnostics(struct signal *s, uint64_t period, int64_t now_ns);

#endif
