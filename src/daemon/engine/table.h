/* SPDX-License-Identifier: MIT */
/*
 * The signal table: one row for each item of the file, in its order, with everything the engine
 * knows of the signal. Allocated once. Row r is record r + 1 of the image.
 */
#pragma once

#include "src/config/read/config.h"
#include "src/daemon/engine/limits/limit.h"
#include "src/daemon/engine/retry.h"
#include "src/ground/signal/filter.h"
#include "src/ground/signal/step.h"
#include "src/ground/signal/value.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/force.h"
#include "src/memory/shm/image.h"

/* Room for the text of a string signal in the layout, bytes; a multiple of 4. */
#define TABLE_TEXT_CAP VALUE_STRING_MAX

#define TABLE_NO_DEVICE UINT32_MAX

/* The controller of a command that none answers for; NAME.force says the same. */
#define CONTROLLER_NOBODY FORCE_NOBODY

/*
 * A reload carries over what stands in sample, attrs and in the structures of a signal that have a
 * name, each of them whole (adopt.c). What stands beside them is of one engine: the place in
 * its table, what its buses have, and what its image's ring has.
 */

/* How reading goes. */
struct signal_reading {
	int64_t known_ns; /* since when the signal is in the table */
	int64_t updated_ns;
	int64_t begun_ns; /* of the reading that gave the last value */
	struct retry retry;
	bool once; /* somebody asks for a reading, past the caches */
	/* quality and error as they stood when the target or the device was lost, if held */
	bool held;
	uint8_t held_quality;
	int32_t held_err;
};

/* What is to be written, what was written, and how writing goes. */
struct signal_command {
	bool given;     /* there is something to write: by a program, or InitValue */
	bool confirmed; /* written is what the bus has */
	bool agrees;    /* it was read back as it was written */
	bool differs;   /* it reads otherwise than it was written */
	bool lapsed;    /* the bus may not have it since: a command goes out, the same value too */
	bool doubted;   /* it did so once: it is read again, past the cache */
	bool one_shot;  /* write once more, changed or not */
	bool forced;    /* a write in doubt ended late: the present value goes out again */
	bool awaited;   /* of before the start: not written until its controller comes back */
	bool said;      /* confirmed on the bus, and its controller knows */
	bool storing;   /* that waits until the value is on the disk (Start "last") */
	int err;        /* of the last write, until one succeeds or writing is disabled */
	int64_t value, written;
	int64_t ended_ns;       /* of the last write: what was asked before says nothing of it */
	int64_t looked_ns;      /* it was asked for past the caches last */
	int64_t unproven_ns;    /* por was cleared after the write then; 0: it was read since */
	enum ows_reason reason; /* how it came into force */
	uint32_t controller;    /* an index of engine.controllers, or CONTROLLER_NOBODY */
	uint32_t stamp;         /* as its controller counts; 0: owsd gave the command */
	uint32_t ticket; /* Start "last": what engine_last.stored() reaches when it is stored */
	uint32_t len, written_len; /* strings: of command_text, written_text */
	struct retry retry;
};

/* When a command that the device lost is written again. */
struct signal_restore {
	int64_t not_before_ns;
	uint8_t doublings;
};

/* What the journal of commands has last of the signal. */
struct signal_journal {
	int64_t entered_ns;
	int64_t until_ns; /* until then the room for entries is used up, one second for each */
	uint32_t serial, reason; /* of the controller of the last entry */
	uint32_t more;           /* commands since that were not entered */
};

/* The limit alarms, and what the journal and the log have of them. */
struct signal_limit {
	struct limit alarm;
	struct log_rate log;
	bool logged;      /* the log has the raised alarm, and gets its return too */
	int64_t value[2]; /* of the update before the last, of the last */
	uint32_t count;   /* sample.count of the last */
	uint8_t values;   /* how many of the two are known */
	uint8_t shelf;    /* shelved: its shelf in the image + 1 */
};

/* What the last change in the ring of this engine's image had. */
struct signal_entered {
	int64_t value, commanded;
	uint32_t count; /* of the last update, entered or not */
	uint32_t alarms;
	uint32_t flags; /* of attrs, that say how the signal stands */
	int32_t err;
	uint8_t quality, detail, target, sample_flags;
	uint8_t limit_state, limit_condition, shelved;
	bool stale; /* good, and older than StaleAfter */
};

/* Between raw and engineering values (scaling.c). */
struct signal_scaling {
	struct filter filter;
	struct step step;
	int64_t written; /* the raw value that was written last, bits of a double */
};

struct signal {
	const struct config_item *item;
	uint32_t record;
	uint32_t device;   /* row of table.devices, or TABLE_NO_DEVICE */
	unsigned lane;     /* which serves it */
	bool shows_device; /* a reading shows that the device is there */

	bool reading, writing; /* a request of the lane is with the bus */
	bool alarming;         /* a request of the alarm machine counts for it */
	uint16_t doubts; /* writes that may still reach it over other targets: it is not written */
	int alarm_err;   /* why its alarm does not come, if OWS_ATTR_ALARM_UNARMED */
	struct signal_entered entered;

	struct ows_sample sample; /* as published */
	struct ows_attrs attrs;
	struct signal_reading read;
	struct signal_command command;
	struct signal_restore restore;
	struct signal_journal journal;
	struct signal_limit limit;
	struct signal_scaling scaling;
	/* strings, TABLE_TEXT_CAP bytes each: published, to be written, written */
	char *text, *command_text, *written_text;
};

/* What is known of a device by the answers for its signals; a reload carries it over. */
struct device_facts {
	const char *identity; /* NULL: not known; else as in struct bus_answer */
	uint8_t supply;       /* enum bus_supply */
	uint8_t wire;         /* N + 1 of its bus.N; 0: not known */
	uint32_t lane;        /* which answered last; UINT32_MAX: none */
	uint64_t answers, errors, retries, wire_us;
	int64_t ok_ns; /* last good answer; 0: none */
};

/* Its power-on flag, as it was read while its outputs were as written. */
enum device_por { POR_UNKNOWN, POR_CLEAR, POR_SET };

struct device {
	uint8_t rom[8];
	bool has_rom;            /* false: an alias */
	bool absent;             /* presence.c: it was looked for, and is not there */
	struct signal **signals; /* in the order of the table; one lane serves them all */
	uint32_t count;
	struct device_facts facts; /* device_facts.c */
	enum device_por por; /* read_back.c; void when it was away, or is written: completion.c */
	int64_t por_ns;      /* it could not be read: while it is not known, not asked for before */

	/* presence.c */
	int64_t shown_ns;   /* an answer has shown last that it is there */
	struct retry watch; /* looks for it that failed */

	/* where it is served, and looked for (known.c, routing.c) */
	unsigned group;
	bool found; /* a target had it once */
	int64_t moved_ns;
	bool probing;    /* queued or with a bus */
	unsigned probed; /* the last group it was looked for on */
	struct retry probe;
	int64_t probe_ns; /* not before; 0: it need not be looked for */
};

struct table {
	struct signal *signals;
	uint32_t count;
	struct device *devices; /* one more than device_count: the rows without a device */
	uint32_t device_count, rom_count; /* those with a ROM id stand first, in its order */
	struct signal **device_signals;
	char *texts;
};

/* Makes a row of each item; nothing is due yet. 0 or -ENOMEM. */
int signal_table_init(struct table *table, const struct config *config);
void signal_table_free(struct table *table);

/* The device with this ROM id, TABLE_NO_DEVICE: no row is of it. */
uint32_t table_device(const struct table *table, const uint8_t rom[8]);

/*
 * The devices of the image: those with a ROM id, in the order of the table. first: room for as many
 * as there are items; gets the first row of each. Their count, or -ENOMEM.
 */
int table_image_devices(const struct config *config, uint32_t *first);

/* What the image of this configuration contains. */
void signal_table_image(const struct config_item *item, struct image_signal *signal);
/* What people say of the signal; strings are those of the item. */
void signal_table_meta(const struct config_item *item, struct image_meta *meta);

/* One past the last signal. */
static inline struct signal *table_end(const struct table *table)
{
	return table->signals + table->count;
}

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
/*
 * Does a command that was written go out again where the device may not have it any more? A set of
 * an input was an event: owsd does not undo what became of it since.
 */
static inline bool signal_repeats(const struct signal *s)
{
	return s->item->output;
}
/*
 * The device may not have any more what was written to it. The next command goes out, the same
 * value too.
 */
static inline void signal_forget_written(struct signal *s)
{
	s->command.lapsed |= s->command.confirmed;
	s->command.confirmed &= !signal_repeats(s);
}
/* Its target or its device is lost: remember how it stood. */
void signal_hold(struct signal *s);
/*
 * What it shows is not known to be so any more: it stands as before the loss, but is the last
 * usable value at best. What was bad stays bad.
 */
void signal_lapse(struct signal *s);
/* Does its commanded value have to go out? */
bool signal_changed(const struct signal *s);
/* Is the command in force what the bus has? */
bool signal_settled(const struct signal *s);

/* Is its path that of a device with a ROM id, so that .device is a row? */
static inline bool signal_has_device(const struct signal *s)
{
	return s->device != TABLE_NO_DEVICE;
}

/* Is it to be read: in the cycle, or to see whether what was written holds? */
bool signal_is_read(const struct signal *s);

/* Good, not read in the cycle, not what was set: nothing would show that it is so no more. */
bool signal_lapses(const struct signal *s);

/* When its value becomes older than StaleAfter; INT64_MAX: never. */
int64_t signal_stale_at(const struct signal *s);

/* A request of this signal begins, ends; an update (value read or written) was made. */
void signal_begin(struct signal *s, uint64_t period);
void signal_end(struct signal *s, uint64_t period, uint64_t begun);
void signal_update(struct signal *s, uint64_t period, int64_t measured_ns, int64_t now_ns);
/* An entry of the journal of alarms for the signal as it stands; it has no values yet. */
struct ows_journal_entry signal_entry(const struct signal *s, enum ows_alarm_kind kind,
                                      enum ows_alarm_event event, int64_t now_ns);
/* The edge of _DGNRESET. */
void signal_reset_diagnostics(struct signal *s, uint64_t period, int64_t now_ns);
