/* SPDX-License-Identifier: MIT */
/* The signals that patterns select, as list and watch show them. */
#pragma once

#include <stdbool.h>

#include "src/faces/show/json.h"
#include "src/faces/show/present.h"
#include "src/faces/show/reading.h"
#include "src/ground/signal/value.h"
#include "src/public/ows.h"
#include "src/tool/owsctl/table.h"

/* What the value of a signal means: unit, decimals, description, and the raw value beside it. */
struct meaning {
	char *unit, *description, *group; /* "": none */
	int decimals;                     /* -1: not known */
	int raw;                          /* the id of _Raw; negative: none */
};

/* All of it copied, so that it outlives ows_reopen(). */
void meaning_of(struct ows *h, const struct ows_info *info, struct meaning *meaning);
void meaning_free(struct meaning *meaning);

/* As members of a JSON object. */
void meaning_json(struct json *json, struct ows *h, const struct meaning *meaning, int64_t now_ns);

struct row {
	int id;     /* for ows_get(); stays valid over ows_reopen() */
	int signal; /* as in ows_info(); -1: a driver signal, which stand first */
	char *name;
	char *path;     /* NULL: a driver signal */
	char *identity; /* likewise */
	uint8_t type;   /* enum ows_type */
	bool output, fresh, alarm;
	struct meaning meaning;         /* of a signal */
	struct ows_alarm_state alarms;  /* of the last row_read() */
	char commanded[VALUE_TEXT_MAX]; /* the last row_read(): the command; "": none or a string */
	bool differs;   /* the last row_read(): the command differs from the value */
	uint64_t state; /* a hash of what the last call of row_changed() saw */
};
struct rows {
	struct row *row;
	int count;
};

/* Collect the signals, with `driver` the driver signals too. Free with rows_free(). */
void rows_collect(struct ows *h, char *const *patterns, int pattern_count, bool driver,
                  struct rows *rows);
void rows_free(struct rows *rows);

/*
 * Was something else commanded than what was read of the id? commanded is the command as a text,
 * "": there is none, or it is a string.
 */
bool command_differs(struct ows *h, int id, const struct reading *reading,
                     char commanded[VALUE_TEXT_MAX]);

/* The same for a person, as the value is shown: "50.7 °C". Returns text. */
#define COMMANDED_WORDS (VALUE_TEXT_MAX + 64)
const char *commanded_text(enum ows_type type, const char *commanded, int decimals,
                           const char *unit, char text[COMMANDED_WORDS]);

/* Read the value of a row, the state of its alarms, and its command. */
void row_read(struct ows *h, struct row *row, int64_t now_ns, struct reading *reading);
/* Can one of the signals have alarms? */
bool rows_have_alarms(struct ows *h, const struct rows *rows);

/* Is there a value to show? The 0 of an input that was never measured is none. */
bool row_filled(const struct row *row, const struct reading *reading);
/* The table that list and watch show. */
enum {
	ROWS_NAME,
	ROWS_VALUE,
	ROWS_UNIT,
	ROWS_QUALITY,
	ROWS_ALARM,
	ROWS_AGE,
	ROWS_TYPE,
	ROWS_IO,
	ROWS_TARGET,
	ROWS_PATH,
	ROWS_COLUMNS,
};
extern const struct table_column rows_columns[ROWS_COLUMNS];
/* Leave out the columns that have nothing for any row. */
void rows_absent(struct ows *h, const struct rows *rows, struct table *table);
/* Add a row to it; whole: the age is in whole seconds. */
void rows_add_cells(struct table *table, struct ows *h, const struct row *row,
                    const struct reading *reading, bool whole);
/* A span in whole seconds: a picture changes no more often. Returns text. */
const char *rows_span(int64_t ns, char text[WHEN_TEXT]);

/* Have value, quality, error or an alarm changed since the last call? */
bool row_changed(struct row *row, const struct reading *reading);

/* The decimals of the value, -1: not known. */
int row_decimals(const struct row *row);

/* name, output, path, alarms and the like as members of a JSON object. */
void row_json(struct json *json, struct ows *h, const struct row *row, int64_t now_ns);

/*
 * Report each pattern that no row matches. Returns CTL_FAILED if there are patterns and no row at
 * all, else 0.
 */
int rows_check(const struct rows *rows, char *const *patterns, int pattern_count);
