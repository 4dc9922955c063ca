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

struct signal {
	const struct config_item *item;
	uint32_t record;
	uint32_t device; /* row of table.devices, or TABLE_NO_DEVICE */
	unsigned lane;   /* which serves it */

	struct ows_sample sample; /* as published */
	struct ows_attrs attrs;
	char *text;       /* strings: published text, TABLE_TEXT_CAP bytes */
	int64_t known_ns; /* since when it is in the table */
	int64_t updated_ns;

	/* reading */
	bool reading;
	struct retry read_retry;
	bool measured; /* quantity says what it can be */
	struct quantity quantity;
	struct guard guard;

	bool alarming; /* a request of the alarm machine counts for it */
	int alarm_err; /* why its alarm cannot be armed, if OWS_ATTR_ALARM_UNARMED */

	/* writing */
	bool writing;
	struct retry write_retry;
	bool commanded; /* there is something to write: by a program, or InitValue */
	bool confirmed; /* written holds what the bus has */
	bool agrees;    /* it was read back as it was written */
	bool one_shot;  /* write once more, changed or not */
	bool forced;    /* a write in doubt ended late: the present value goes out again */
	bool safe;      /* put to SafeValue, its client stopped beating */
	int write_err;  /* of the last write, until one succeeds or writing is disabled */
	int64_t command, written;
	uint32_t command_stamp;            /* of command; stamp may be that of a refused one */
	char *command_text, *written_text; /* strings */
	uint32_t command_len, written_len;
	uint32_t client; /* 0: nobody who beats; else index + 1 */
	bool awaited; /* its command is of before the start: nothing is written until client beats */
	uint16_t doubts; /* writes that may still reach it over other targets: it is not written */

	/* what was last seen in the command segment */
	uint32_t stamp, one_shots, dgn_resets, acknowledged;

	/* as it stood when its target was lost */
	bool held;
	uint8_t held_quality;
	int32_t held_err;

	/* limit alarms */
	struct limit limit;
	struct log_rate limit_log;
	bool limit_said;        /* the log has what was raised: it gets the return too */
	int64_t limit_value[2]; /* of the update before the last, of the last */
	uint32_t limit_count;   /* sample.count of the last */
	uint8_t limit_values;   /* how many of the two are known */
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
