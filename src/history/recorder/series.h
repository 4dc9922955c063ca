/* SPDX-License-Identifier: MIT */
/*
 * The rows of the recorder: of each signal of owsd its rule, and what was kept last. Values go from
 * libows through the rule to the writer of history. Allocates in series_make() alone.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/config/read/config.h"
#include "src/history/file/record.h"
#include "src/history/file/writer.h"
#include "src/history/recorder/rule.h"
#include "src/public/ows.h"

struct row {
	struct config_record rule;
	struct rule_kept kept;
	int raw_id;       /* of ows_find(): NAME_Raw; negative: it is not kept */
	uint32_t raw_row; /* in the table of the history */
	struct rule_kept raw_kept;
	uint32_t count; /* of ows_value, when the value was looked at last */
};
struct series {
	struct row *rows;
	uint32_t generation; /* of the image that the rows are of */
	int count;    /* signals of owsd; the table of the history has raw values after them */
	int recorded; /* those that are not off */
	bool has_intervals; /* some rule has an interval */
	int missed;       /* signals of which something between two values may not have been seen */
	int64_t last_ns;  /* the greatest time that was given to the writer */
	int64_t since_ns; /* since then owsd is looked at; an older value counts from then on */
};

/*
 * Make the rows of the present image, by the names in the configuration, and give the writer the
 * table. Each value is kept anew. 0, -ENOMEM, -E2BIG: the rows are empty then.
 */
int series_make(struct series *rows, struct ows *ows, const struct config *config,
                struct history_writer *writer, int64_t now_ns);
void series_free(struct series *rows);

/* Rows of the image that ows has: those of another one must not be used with it. */
bool series_are_of(const struct series *rows, struct ows *ows, int64_t now_ns);

/*
 * Signals that changed; signals NULL: look at all. unseen_ns: the recorder has not looked since
 * then, though it was due; 0: all looks were in time. A signal that was measured more than once
 * since then has a gap from then to its newest value.
 */
void series_changes(struct series *rows, struct ows *ows, struct history_writer *writer,
                    const int *signals, int n, int64_t unseen_ns, int64_t now_ns);
/*
 * Keep what is due by intervals at wall_ns. Returns the wall-clock time of the next tick, INT64_MAX
 * without intervals. unseen_ns: of the ticks, likewise.
 */
int64_t series_tick(struct series *rows, struct ows *ows, struct history_writer *writer,
                    int64_t unseen_ns, int64_t now_ns, int64_t wall_ns);
/* Nothing was known until now: each value is kept anew, as of now if it is older. */
void series_forget(struct series *rows, int64_t now_ns);

/* The time that the history has of a value: none reaches back into a gap. Pure. */
int64_t series_time(const struct series *rows, const struct ows_value *v, int64_t now_ns);
/* A value as the history has it: bits of a double, or an integer. Pure. */
int64_t series_bits(uint8_t type, double number, int64_t integer);

/* Entries of the two journals of owsd, of alarms and of commands, as events of history. Pure. */
struct history_event entries_alarm(const struct ows_alarm *alarm);
struct history_event entries_command(const struct ows_commanded *command);
