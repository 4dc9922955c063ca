/* SPDX-License-Identifier: MIT */
/* From values of libows through the rules to the writer of history. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/read/recorder.h"
#include "src/faces/show/newest.h"
#include "src/ground/signal/value.h"
#include "src/history/recorder/series.h"

int64_t series_bits(uint8_t type, double number, int64_t integer)
{
	return value_is_float((enum ows_type)type) ? value_of_double(number) : integer;
}

/* --- Entries of the journals ----------------------------------------------------------------- */

static void put_rest(struct history_event *event, const struct ows_by *by, const char *text)
{
	event->who = (struct history_who){.serial = by->serial, .uid = by->uid, .pid = by->pid};
	memcpy(event->who.name, by->name, sizeof(event->who.name));
	memcpy(event->who.person, by->person, sizeof(event->who.person));
	snprintf(event->text, sizeof(event->text), "%s", text);
}

struct history_event entries_alarm(const struct ows_alarm *alarm)
{
	struct history_event event = {
		.kind = OWS_HISTORY_ALARM,
		.type = alarm->type,
		.quality = alarm->quality,
		.reason = alarm->kind,
		.event = alarm->event,
		.has_value = alarm->has_after,
		.has_before = alarm->has_before,
		.signal = (uint32_t)alarm->signal,
		.time_ns = alarm->occurred_ns,
		.value = series_bits(alarm->type, alarm->after, alarm->after_integer),
		.before = series_bits(alarm->type, alarm->before, alarm->before_integer),
	};

	put_rest(&event, &alarm->who, alarm->text);
	return event;
}

struct history_event entries_command(const struct ows_commanded *command)
{
	struct history_event event = {
		.kind = OWS_HISTORY_COMMAND,
		.type = command->type,
		.quality = command->quality,
		.reason = command->reason,
		.has_value = command->type != OWS_STRING,
		.signal = (uint32_t)command->signal,
		.time_ns = command->taken_ns,
		.value = series_bits(command->type, command->number, command->integer),
	};

	put_rest(&event, &command->who, command->text);
	return event;
}

/* --- The rows -------------------------------------------------------------------------------- */

/* By name: the file may have changed since owsd read it. Sorted once, for a table of thousands. */
struct named {
	const char *name;
	const struct config_item *item;
};

static int by_item_name(const void *a, const void *b)
{
	return strcmp(((const struct named *)a)->name, ((const struct named *)b)->name);
}

static struct named *sort_items(const struct config *config)
{
	struct named *sorted = calloc(config->item_count + 1, sizeof(*sorted));

	for (unsigned i = 0; sorted && i < config->item_count; i++)
		sorted[i] = (struct named){config->items[i].name, &config->items[i]};
	if (sorted)
		qsort(sorted, config->item_count, sizeof(*sorted), by_item_name);
	return sorted;
}

/* The rule of a signal; one that the file does not have gets that of the block. */
static struct config_record rule_of(const struct config *config, const struct named *sorted,
                                    const struct ows_info *info)
{
	struct named wanted = {.name = info->name};
	struct config_item unknown = {.type = (enum ows_type)info->type};
	const struct named *found = bsearch(&wanted, sorted, config->item_count, sizeof(*sorted),
	                                    by_item_name);

	return config_record_of(config, found ? found->item : &unknown);
}

/* The table of the history: the signals, then the raw values. */
struct table {
	struct history_signal *signals;
	struct raw_words {
		char name[HISTORY_NAME], identity[HISTORY_IDENTITY];
	} * words; /* of the raw values */
	uint32_t count;
};

static void add_raw(struct table *table, struct row *row, struct ows *ows,
                    const struct ows_info *info)
{
	struct raw_words *raw = &table->words[table->count - (uint32_t)ows_count(ows)];

	row->raw_id = -1;
	if (!row->rule.raw || row->rule.off || info->type == OWS_STRING ||
	    snprintf(raw->name, HISTORY_NAME, "%s_Raw", info->name) >= HISTORY_NAME)
		return;
	snprintf(raw->identity, HISTORY_IDENTITY, "%s_Raw", info->identity);
	row->raw_id = ows_find(ows, raw->name);
	if (row->raw_id < 0)
		return;
	row->raw_row = table->count;
	table->signals[table->count++] = (struct history_signal){.name = raw->name,
	                                                         .unit = "",
	                                                         .type = OWS_DOUBLE,
	                                                         .decimals = -1,
	                                                         .identity = raw->identity};
}

static void series_fill(struct series *rows, struct table *table, struct ows *ows,
                        const struct config *config, const struct named *sorted)
{
	struct ows_info info;

	table->count = (uint32_t)rows->count;
	for (int i = 0; i < rows->count; i++) {
		struct row *row = &rows->rows[i];

		ows_info(ows, i, &info);
		*row = (struct row){.rule = rule_of(config, sorted, &info)};
		table->signals[i] = (struct history_signal){
			.name = info.name,
			.unit = info.unit,
			.type = info.type,
			.output = info.output,
			.decimals = (int8_t)info.decimals,
			.identity = info.identity,
		};
		rows->recorded += !row->rule.off;
		rows->has_intervals |= row->rule.interval_ns > 0;
		add_raw(table, row, ows, &info);
	}
}

/* 0: not known, for a moment, of an owsd that died in the middle of a heartbeat. */
static uint32_t generation_of(struct ows *ows, int64_t now_ns)
{
	struct ows_daemon daemon = {0};

	return ows_daemon(ows, now_ns, &daemon) == -EAGAIN ? 0 : daemon.generation;
}

bool series_are_of(const struct series *rows, struct ows *ows, int64_t now_ns)
{
	uint32_t generation = generation_of(ows, now_ns);

	return !rows->generation || !generation || rows->generation == generation;
}

int series_make(struct series *rows, struct ows *ows, const struct config *config,
                struct history_writer *writer, int64_t now_ns)
{
	size_t count = (size_t)ows_count(ows);
	struct named *sorted = sort_items(config);
	struct table table = {
		.signals = calloc(2 * count + 1, sizeof(*table.signals)),
		.words = calloc(count + 1, sizeof(*table.words)),
	};
	int err = -ENOMEM;

	series_free(rows);
	rows->rows = calloc(count + 1, sizeof(*rows->rows));
	if (rows->rows && sorted && table.signals && table.words) {
		rows->count = (int)count;
		rows->generation = generation_of(ows, now_ns);
		series_fill(rows, &table, ows, config, sorted);
		err = history_writer_signals(writer, table.signals, table.count, now_ns);
	}
	for (int i = 0; !err && i < rows->count; i++)
		if (rows->rows[i].rule.off)
			history_writer_forget(writer, (uint32_t)i, now_ns, OWS_HISTORY_NOT_ASKED);
	if (err)
		series_free(rows);
	free(sorted);
	free(table.signals);
	free(table.words);
	return err;
}

void series_free(struct series *rows)
{
	free(rows->rows);
	*rows = (struct series){.last_ns = rows->last_ns, .since_ns = rows->since_ns};
}

int64_t series_time(const struct series *rows, const struct ows_value *v, int64_t now_ns)
{
	int64_t time_ns = face_value_time(v, now_ns);

	return time_ns < rows->since_ns ? rows->since_ns : time_ns;
}

static void keep_sample(struct series *rows, struct rule_kept *kept, const struct ows_value *v,
                        struct history_writer *writer, uint32_t number, const char *text,
                        int64_t now_ns)
{
	int64_t time_ns = series_time(rows, v, now_ns);
	int64_t bits = v->type == OWS_STRING ? 0 : series_bits(v->type, v->number, v->integer);

	history_writer_value(writer, number, time_ns, v->quality, bits, text, strlen(text));
	kept->any = true;
	kept->sample = *v;
	if (time_ns > rows->last_ns)
		rows->last_ns = time_ns;
}

/* The raw value goes where the value goes, by the same occasion. */
static void keep_raw(struct series *rows, struct row *row, struct ows *ows,
                     struct history_writer *writer, int64_t now_ns)
{
	struct ows_value v;

	if (row->raw_id >= 0 && !ows_get(ows, row->raw_id, now_ns, &v))
		keep_sample(rows, &row->raw_kept, &v, writer, row->raw_row, "", now_ns);
}

/* Nothing is known of the signal from then on, or from what was kept later. */
static void miss(struct series *rows, struct row *row, int signal, struct history_writer *writer,
                 int64_t unseen_ns)
{
	history_writer_forget(writer, (uint32_t)signal, unseen_ns, OWS_HISTORY_OVERRUN);
	if (row->raw_id >= 0)
		history_writer_forget(writer, row->raw_row, unseen_ns, OWS_HISTORY_OVERRUN);
	row->kept.any = row->raw_kept.any = false;
	rows->missed++;
}

static void series_take(struct series *rows, int signal, struct ows *ows,
                        struct history_writer *writer, bool ticked, int64_t unseen_ns,
                        int64_t now_ns)
{
	struct row *row = &rows->rows[signal];
	struct face_value value;
	struct ows_value *v = &value.v;

	if (row->rule.off)
		return;
	face_value(ows, signal, true, now_ns, &value);
	/* FACE_LOST, or the next look at the changes, says of the others why they are not known */
	if (!value.known)
		return;
	if (v->type == OWS_STRING)
		v->integer = (int64_t)face_value_print(v, value.text);
	if (rule_missed(&row->rule, &row->kept, v->count - row->count, ticked, unseen_ns, now_ns))
		miss(rows, row, signal, writer, unseen_ns);
	row->count = v->count;
	if (!rule_change(&row->rule, &row->kept, v) && !(ticked && rule_interval(&row->kept, v)))
		return;
	keep_sample(rows, &row->kept, v, writer, (uint32_t)signal, value.text, now_ns);
	keep_raw(rows, row, ows, writer, now_ns);
}

void series_changes(struct series *rows, struct ows *ows, struct history_writer *writer,
                    const int *signals, int n, int64_t unseen_ns, int64_t now_ns)
{
	int count = signals ? n : rows->count;

	for (int i = 0; i < count; i++) {
		int signal = signals ? signals[i] : i;

		if (signal >= 0 && signal < rows->count)
			series_take(rows, signal, ows, writer, false, unseen_ns, now_ns);
	}
}

int64_t series_tick(struct series *rows, struct ows *ows, struct history_writer *writer,
                    int64_t unseen_ns, int64_t now_ns, int64_t wall_ns)
{
	int64_t next = INT64_MAX;

	for (int i = 0; rows->has_intervals && i < rows->count; i++) {
		struct row *row = &rows->rows[i];
		int64_t due;

		if (rule_tick(&row->rule, &row->kept, wall_ns))
			series_take(rows, i, ows, writer, true, unseen_ns, now_ns);
		due = rule_next_tick(&row->rule, wall_ns);
		next = due < next ? due : next;
	}
	return next;
}

void series_forget(struct series *rows, int64_t now_ns)
{
	rows->since_ns = now_ns;
	for (int i = 0; i < rows->count; i++)
		rows->rows[i].kept.any = rows->rows[i].raw_kept.any = false;
}
