/* SPDX-License-Identifier: MIT */
/*
 * The signals that patterns select, and the state of each. A row has copies of names and units,
 * because ows_reopen() unmaps the image that ows_info() points into.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/show/digits.h"
#include "src/faces/show/names.h"
#include "src/ground/signal/hash.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/rows.h"

void meaning_of(struct ows *h, const struct ows_info *info, struct meaning *meaning)
{
	char raw[NAMES_MAX];

	snprintf(raw, sizeof(raw), "%s%s", info->name, attribute_table[ATTR_RAW].name);
	*meaning = (struct meaning){
		.unit = ctl_need(strdup(info->unit)),
		.description = ctl_need(strdup(info->description)),
		.group = ctl_need(strdup(info->group)),
		.decimals = info->decimals,
		.raw = info->type == OWS_STRING ? -1 : ows_find(h, raw),
	};
}

void meaning_free(struct meaning *meaning)
{
	free(meaning->unit);
	free(meaning->description);
	free(meaning->group);
	*meaning = (struct meaning){0};
}

static void raw_json(struct json *json, struct ows *h, int id, int64_t now_ns)
{
	char text[VALUE_TEXT_MAX];
	struct ows_value raw;
	int err = id < 0 ? -ENOENT : ows_get(h, id, now_ns, &raw);

	if ((err && err != -ESTALE) || !raw.measured_ns) {
		json_null(json, "raw");
		return;
	}
	value_to_text(OWS_DOUBLE, value_of_double(raw.number), text);
	json_number(json, "raw", text);
}

void meaning_json(struct json *json, struct ows *h, const struct meaning *meaning, int64_t now_ns)
{
	json_string(json, "unit", *meaning->unit ? meaning->unit : NULL);
	json_known(json, "decimals", meaning->decimals);
	json_string(json, "description", *meaning->description ? meaning->description : NULL);
	json_string(json, "group", *meaning->group ? meaning->group : NULL);
	raw_json(json, h, meaning->raw, now_ns);
}

static void rows_add(struct ows *h, struct rows *rows, const char *name, int signal,
                     const struct ows_info *info)
{
	struct row *row = &rows->row[rows->count++];

	memset(row, 0, sizeof(*row));
	row->id = ows_find(h, name);
	row->signal = signal;
	row->name = ctl_need(strdup(name));
	if (!info)
		return;
	row->type = info->type;
	row->output = info->output;
	row->fresh = info->fresh;
	row->alarm = info->alarm;
	row->path = ctl_need(strdup(info->path));
	row->identity = ctl_need(strdup(info->identity));
	meaning_of(h, info, &row->meaning);
}

void rows_collect(struct ows *h, char *const *patterns, int pattern_count, bool driver,
                  struct rows *rows)
{
	int count = ows_count(h);

	rows->count = 0;
	rows->row = ctl_need(calloc((size_t)count + ATTR_COUNT, sizeof(*rows->row)));
	for (int i = 0; driver && i < ATTR_COUNT; i++) {
		const struct attribute_def *def = &attribute_table[i];

		if (def->driver && def->readable && names_match(def->name, patterns, pattern_count))
			rows_add(h, rows, def->name, -1, NULL);
	}
	for (int i = 0; i < count; i++) {
		struct ows_info info;

		if (ows_info(h, i, &info) == 0 && names_match(info.name, patterns, pattern_count))
			rows_add(h, rows, info.name, i, &info);
	}
}

static bool matches_some(const struct rows *rows, char *const *pattern)
{
	for (int i = 0; i < rows->count; i++)
		if (names_match(rows->row[i].name, pattern, 1))
			return true;
	return false;
}

int rows_check(const struct rows *rows, char *const *patterns, int pattern_count)
{
	int status = 0;

	for (int i = 0; i < pattern_count; i++)
		if (!matches_some(rows, patterns + i))
			status = ctl_fail("no signal matches %s", ctl_word(patterns[i]));
	return rows->count ? 0 : status;
}

void rows_free(struct rows *rows)
{
	for (int i = 0; i < rows->count; i++) {
		free(rows->row[i].name);
		free(rows->row[i].path);
		free(rows->row[i].identity);
		meaning_free(&rows->row[i].meaning);
	}
	free(rows->row);
	rows->row = NULL;
	rows->count = 0;
}

bool command_differs(struct ows *h, int id, const struct reading *reading,
                     char commanded[VALUE_TEXT_MAX])
{
	enum ows_type type = (enum ows_type)reading->value.type;
	struct ows_command command;
	int err = ows_command(h, id, &command);
	int64_t value;

	commanded[0] = '\0';
	if ((err && err != -ESTALE) || !command.given)
		return false;
	value = value_is_float(type) ? value_of_double(command.number) : command.integer;
	value_to_text(type, value, commanded);
	return value_is_float(type) ? command.number != reading->value.number
	                            : command.integer != reading->value.integer;
}

const char *commanded_text(enum ows_type type, const char *commanded, int decimals,
                           const char *unit, char text[COMMANDED_WORDS])
{
	char number[VALUE_TEXT_MAX];

	snprintf(number, sizeof(number), "%s", commanded);
	if (value_is_float(type))
		digits_print(type, strtod(commanded, NULL), 0, decimals, number);
	snprintf(text, COMMANDED_WORDS, "%s%s%s", number, *unit ? " " : "", unit);
	return text;
}

void row_read(struct ows *h, struct row *row, int64_t now_ns, struct reading *reading)
{
	reading_get(h, row->id, now_ns, reading);
	row->alarms = standing_of(h, row->id);
	row->differs = command_differs(h, row->id, reading, row->commanded);
}

bool row_filled(const struct row *row, const struct reading *reading)
{
	if (!row->path)
		return reading_filled(reading);
	return reading_has_value(reading) && (row->output || reading->value.measured_ns);
}

bool rows_have_alarms(struct ows *h, const struct rows *rows)
{
	for (int i = 0; i < rows->count; i++) {
		struct ows_alarm_state alarms = standing_of(h, rows->row[i].id);

		if (standing_possible(&alarms))
			return true;
	}
	return false;
}

bool row_changed(struct row *row, const struct reading *reading)
{
	const struct ows_alarm_state *alarms = &row->alarms;
	bool filled = reading_filled(reading);
	int32_t err = filled ? reading->value.err : reading->err;
	const char bytes[] = {(char)(filled ? reading->value.quality : 0), (char)alarms->stands,
	                      (char)alarms->unarmed, (char)alarms->limit_state,
	                      (char)alarms->limit_kind};
	uint64_t before = row->state;

	row->state = hash_text(HASH_BEGIN, reading->text, reading->len);
	row->state = hash_text(row->state, (const char *)&err, sizeof(err));
	row->state = hash_text(row->state, bytes, sizeof(bytes));
	return row->state != before;
}

int row_decimals(const struct row *row)
{
	return row->path ? row->meaning.decimals : -1;
}

const struct table_column rows_columns[ROWS_COLUMNS] = {
	[ROWS_NAME] = {"NAME", .shrink = 24},
	[ROWS_VALUE] = {"VALUE", .right = true, .most = 40},
	[ROWS_UNIT] = {"UNIT", .drop = 4},
	[ROWS_QUALITY] = {"QUALITY", .shrink = 13}, /* "device absent" */
	[ROWS_ALARM] = {"ALARM", .shrink = 8},
	[ROWS_AGE] = {"AGE", .right = true, .drop = 2},
	[ROWS_TYPE] = {"TYPE"},
	[ROWS_IO] = {"IO"},
	[ROWS_TARGET] = {"TARGET", .drop = 3, .spare = true},
	[ROWS_PATH] = {"PATH", .drop = 1, .shrink = 16}, /* "/28.551DDF030000" */
};

void rows_absent(struct ows *h, const struct rows *rows, struct table *table)
{
	table->absent[ROWS_UNIT] = true;
	for (int i = 0; i < rows->count; i++)
		table->absent[ROWS_UNIT] &= !rows->row[i].path || !*rows->row[i].meaning.unit;
	table->absent[ROWS_ALARM] = !rows_have_alarms(h, rows);
}

const char *rows_span(int64_t ns, char text[WHEN_TEXT])
{
	if (ns < 0 || ns >= 60 * NS_PER_S)
		return when_span(ns, text);
	snprintf(text, WHEN_TEXT, "%ds", (int)(ns / NS_PER_S));
	return text;
}

void rows_add_cells(struct table *table, struct ows *h, const struct row *row,
                    const struct reading *reading, bool whole)
{
	char commanded[COMMANDED_WORDS];
	char value[128] = "-", words[READING_WORDS], alarm[STANDING_WORDS], span[WHEN_TEXT] = "-";
	size_t len = strlen(reading_quality(reading, words));
	struct ows_target target = {.name = "-"};

	if (row->differs)
		snprintf(words + len, sizeof(words) - len, "; commanded %s",
		         commanded_text((enum ows_type)row->type, row->commanded,
		                        row->meaning.decimals, row->meaning.unit, commanded));
	if (row_filled(row, reading))
		reading_show(reading, value, sizeof(value));
	if (reading->value.measured_ns && whole)
		rows_span(reading->value.age_ns, span);
	else if (reading->value.measured_ns)
		when_span(reading->value.age_ns, span);
	if (row->path)
		ows_target(h, reading->value.target, &target);
	table_add(table, (const char *const[ROWS_COLUMNS]){
				 [ROWS_NAME] = row->name,
				 [ROWS_VALUE] = value,
				 [ROWS_UNIT] = row->path ? row->meaning.unit : "",
				 [ROWS_QUALITY] = words,
				 [ROWS_ALARM] = standing_text(&row->alarms, alarm),
				 [ROWS_AGE] = span,
				 [ROWS_TYPE] = value_type_name((enum ows_type)reading->value.type),
				 [ROWS_IO] = !row->path    ? ""
	                                     : row->output ? "out"
	                                                   : "in",
				 [ROWS_TARGET] = target.name,
				 [ROWS_PATH] = row->path ? row->path : "",
			 });
}

void row_json(struct json *json, struct ows *h, const struct row *row, int64_t now_ns)
{
	json_string(json, "name", row->name);
	json_string(json, "path", row->path);
	if (!row->path)
		return;
	json_string(json, "identity", row->identity);
	json_string(json, "io", row->output ? "output" : "input");
	json_bool(json, "uncached", row->fresh);
	json_bool(json, "alarm", row->alarm);
	if (row->type == OWS_BOOL && row->commanded[0])
		json_bool(json, "commanded", row->commanded[0] == '1');
	else
		json_number(json, "commanded", row->commanded);
	meaning_json(json, h, &row->meaning, now_ns);
	standing_json(json, &row->alarms);
}
