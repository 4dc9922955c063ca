/* SPDX-License-Identifier: MIT */
/* Rows in memory, and when they go to the file. */
#include "src/history/file/writer.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/history/file/schema.h"
#include "src/history/file/store.h"

#define NS_PER_US 1000
#define SECOND_US INT64_C(1000000)
#define FLUSH_US MINUTE_US
#define MEMORY (4u << 20)
/* Values of the same time reach the recorder one after the other: so long they wait for others */
#define LATE_US SECOND_US
#define RETRY_US SECOND_US
#define RETRY_MOST_US (60 * SECOND_US)
#define ALL UINT32_MAX

/* What a signal has, beside its key. */
struct kept {
	int64_t us; /* of its last row; nothing older comes after it */
	int64_t value;
	int64_t row_us; /* when it was repeated, or came */
	char *text;
	uint8_t quality, type;
	bool known;
};
struct history_writer {
	struct history_store store;
	char *directory;
	int64_t flush_us;
	struct history_key *keys; /* all that ever were in the table */
	struct kept *kept;        /* of each of them */
	uint32_t key_count;
	uint32_t *table; /* a signal's key */
	uint32_t count;
	struct history_row *rows;
	uint32_t row_count, row_most, seq;
	size_t text_bytes, text_most;
	int64_t offset_us;
	bool trusted;
	int64_t newest_us; /* no gap of all begins before it: of all rows, and after a value */
	int64_t floor_us;  /* the end of the last gap of all */
	int64_t begin_us, flushed_us, retry_us, step_us, repeat_us;
	uint32_t files; /* begun so far; another number: the present one has nothing of before */
	int error;
	uint64_t dropped;
};

int history_writer_open(const struct history_options *options, int64_t now_ns, int64_t offset_ns,
                        bool trusted, struct history_writer **writer)
{
	uint32_t bytes = options->memory_bytes ? options->memory_bytes : MEMORY;
	struct history_writer *w = calloc(1, sizeof(*w));

	*writer = NULL;
	if (!w)
		return -ENOMEM;
	w->row_most = bytes / (uint32_t)sizeof(*w->rows) + 2;
	w->text_most = bytes;
	w->rows = calloc(w->row_most, sizeof(*w->rows));
	w->directory = strdup(options->directory);
	if (!w->rows || !w->directory) {
		free(w->rows);
		free(w->directory);
		free(w);
		return -ENOMEM;
	}
	w->store = (struct history_store){
		.file = {.directory = w->directory, .say = options->say, .ctx = options->ctx},
		.keep = options->keep,
		.boot = options->boot,
	};
	store_begin(&w->store);
	w->flush_us = options->flush_ns > 0 ? options->flush_ns / NS_PER_US : FLUSH_US;
	w->begin_us = w->flushed_us = w->repeat_us = now_ns / NS_PER_US;
	w->floor_us = w->newest_us = w->begin_us;
	w->offset_us = offset_ns / NS_PER_US;
	w->trusted = trusted;
	*writer = w;
	return 0;
}

/*
 * --- Memory ------------------------------------------------------------------------------------
 */

static void free_row(struct history_writer *w, struct history_row *row)
{
	if (row->text)
		w->text_bytes -= strlen(row->text) + 1;
	if (row->event)
		w->text_bytes -= sizeof(*row->event);
	free(row->text);
	free(row->event);
	row->text = NULL;
	row->event = NULL;
}

static int by_time(const void *a, const void *b)
{
	const struct history_row *left = a, *right = b;

	if (left->us != right->us)
		return left->us < right->us ? -1 : 1;
	return left->seq < right->seq ? -1 : left->seq > right->seq;
}

static void sort_rows(struct history_writer *w)
{
	qsort(w->rows, w->row_count, sizeof(*w->rows), by_time);
	for (uint32_t i = 0; i < w->row_count; i++)
		w->rows[i].seq = i;
	w->seq = w->row_count;
}

/* The first rows are not needed any more. */
static void remove_rows(struct history_writer *w, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		free_row(w, &w->rows[i]);
	w->row_count -= count;
	memmove(w->rows, w->rows + count, w->row_count * sizeof(*w->rows));
}

/*
 * Memory is full: the oldest half becomes a gap, after which each signal has what it had at its
 * end. Signals that are too many for that are known again when they are repeated.
 */
static void drop_half(struct history_writer *w)
{
	uint32_t half, left = 0, *last = calloc(w->key_count + 1, sizeof(*last));
	struct history_row gap = {.kind = ROW_GAP, .key = ALL, .reason = OWS_HISTORY_DISK};

	sort_rows(w);
	half = w->row_count / 2;
	gap.us = w->rows[0].us;
	gap.value = w->rows[half].us;
	for (uint32_t i = 0; last && i < half; i++) {
		const struct history_row *row = &w->rows[i];

		if (row->kind == ROW_VALUE)
			last[row->key] = i + 1;
		else if (row->kind == ROW_GAP && row->key == ALL)
			memset(last, 0, w->key_count * sizeof(*last));
		else if (row->kind == ROW_GAP)
			last[row->key] = 0;
	}
	for (uint32_t i = 0; i < half; i++) {
		struct history_row *row = &w->rows[i];

		if (last && row->kind == ROW_VALUE && last[row->key] == i + 1 && left < half / 2) {
			w->rows[left] = *row;
			w->rows[left++].us = gap.value;
		} else {
			free_row(w, row);
		}
	}
	free(last);
	w->dropped += half - left;
	w->rows[left++] = gap;
	memmove(w->rows + left, w->rows + half, (w->row_count - half) * sizeof(*w->rows));
	w->row_count -= half - left;
	sort_rows(w);
}

/* Texts and events count too. The row's memory belongs to the writer now. */
static void writer_add(struct history_writer *w, struct history_row row)
{
	size_t bytes = row.text ? strlen(row.text) + 1 : row.event ? sizeof(*row.event) : 0;

	while (w->row_count > 8 &&
	       (w->row_count + 1 >= w->row_most || w->text_bytes + bytes > w->text_most))
		drop_half(w);
	row.seq = w->seq++;
	w->text_bytes += bytes;
	w->rows[w->row_count++] = row;
	if (row.us >= w->newest_us && row.kind != ROW_EVENT)
		w->newest_us = row.us + (row.kind == ROW_VALUE);
}

/*
 * --- What the recorder says --------------------------------------------------------------------
 */

/* Among the first keys; mostly it is the one that is guessed. */
static int find_key(const struct history_writer *w, const char *identity, uint32_t count,
                    uint32_t guess)
{
	for (uint32_t i = 0; i < count; i++)
		if (strcmp(w->keys[(guess + i) % count].identity, identity) == 0)
			return (int)((guess + i) % count);
	return -ENOENT;
}

static void set_key(struct history_key *key, const struct history_signal *signal)
{
	snprintf(key->identity, sizeof(key->identity), "%s", history_identity(signal));
	snprintf(key->name, sizeof(key->name), "%s", signal->name);
	snprintf(key->unit, sizeof(key->unit), "%s", signal->unit);
	key->type = signal->type;
	key->output = signal->output;
	key->decimals = signal->decimals;
	key->number = 0; /* the file may have something else of it */
}

static int room_for_keys(struct history_writer *w, uint32_t count)
{
	struct history_key *keys = reallocarray(w->keys, count + 1, sizeof(*keys));
	struct kept *kept;

	if (keys)
		w->keys = keys;
	kept = reallocarray(w->kept, count + 1, sizeof(*kept));
	if (kept)
		w->kept = kept;
	return keys && kept ? 0 : -ENOMEM;
}

static void writer_forget(struct history_writer *w, uint32_t key, int64_t us, uint8_t reason)
{
	struct kept *kept = &w->kept[key];

	if (us < kept->us)
		us = kept->us;
	kept->us = us;
	kept->known = false;
	writer_add(w,
	           (struct history_row){.kind = ROW_GAP, .us = us, .key = key, .reason = reason});
}

int history_writer_signals(struct history_writer *w, const struct history_signal *signals,
                           uint32_t count, int64_t now_ns)
{
	uint32_t *table = calloc(count + 1, sizeof(*table));
	bool *there = calloc(w->key_count + count + 1, sizeof(*there));
	int err = table && there ? room_for_keys(w, w->key_count + count) : -ENOMEM;
	uint32_t before = w->key_count;

	if (!err && w->key_count + count > HISTORY_SIGNALS)
		err = -E2BIG;
	for (uint32_t i = 0; !err && i < count; i++) {
		int at = find_key(w, history_identity(&signals[i]), before,
		                  i < w->count ? w->table[i] : 0);

		if (at < 0) {
			at = (int)w->key_count++;
			w->kept[at] = (struct kept){.us = w->floor_us};
			w->keys[at] = (struct history_key){0};
		}
		set_key(&w->keys[at], &signals[i]);
		table[i] = (uint32_t)at;
		there[at] = true;
	}
	for (uint32_t i = 0; !err && i < w->key_count; i++) {
		if (!there[i])
			history_key_leave(&w->keys[i], signals, count);
		if (!there[i] && w->kept[i].known)
			writer_forget(w, i, now_ns / NS_PER_US, OWS_HISTORY_NOT_ASKED);
	}
	free(there);
	free(err ? table : w->table);
	if (err)
		return err;
	w->table = table;
	w->count = count;
	return 0;
}

/* Nothing that comes is older. */
static void forget_all(struct history_writer *w, int64_t until_us)
{
	for (uint32_t i = 0; i < w->key_count; i++)
		w->kept[i].known = false;
	if (until_us > w->floor_us)
		w->floor_us = until_us;
}

static void gap_of_all(struct history_writer *w, int64_t from_us, int64_t until_us, uint8_t reason)
{
	if (from_us < w->newest_us)
		from_us = w->newest_us;
	if (until_us < from_us)
		until_us = from_us;
	forget_all(w, from_us);
	writer_add(w, (struct history_row){.kind = ROW_GAP,
	                                   .us = from_us,
	                                   .value = until_us,
	                                   .key = ALL,
	                                   .reason = reason});
}

void history_writer_gap(struct history_writer *w, int64_t from_ns, int64_t until_ns,
                        enum ows_history_reason reason)
{
	gap_of_all(w, from_ns / NS_PER_US, until_ns / NS_PER_US, (uint8_t)reason);
}

void history_writer_begin(struct history_writer *w, int64_t now_ns)
{
	forget_all(w, now_ns / NS_PER_US);
}

void history_writer_forget(struct history_writer *w, uint32_t signal, int64_t from_ns,
                           enum ows_history_reason reason)
{
	if (signal < w->count)
		writer_forget(w, w->table[signal], from_ns / NS_PER_US, (uint8_t)reason);
}

static void add_value_row(struct history_writer *w, uint32_t key, int64_t us)
{
	struct kept *kept = &w->kept[key];

	kept->row_us = us;
	writer_add(w, (struct history_row){
			      .kind = ROW_VALUE,
			      .us = us,
			      .value = kept->value,
			      .text = kept->text ? strdup(kept->text) : NULL,
			      .key = key,
			      .type = kept->type,
			      .quality = kept->quality,
		      });
}

void history_writer_value(struct history_writer *w, uint32_t signal, int64_t measured_ns,
                          uint8_t quality, int64_t value, const char *text, size_t len)
{
	int64_t us = measured_ns / NS_PER_US;
	struct kept *kept;

	if (signal >= w->count)
		return;
	kept = &w->kept[w->table[signal]];
	if (us < w->floor_us)
		us = w->floor_us;
	if (us < kept->us)
		us = kept->us;
	free(kept->text);
	kept->type = w->keys[w->table[signal]].type;
	kept->text = kept->type == OWS_STRING && text ? strndup(text, len) : NULL;
	kept->value = value;
	kept->quality = quality;
	kept->known = true;
	kept->us = us;
	add_value_row(w, w->table[signal], us);
}

void history_writer_event(struct history_writer *w, const struct history_event *event)
{
	struct history_event *copy = event->signal < w->count ? malloc(sizeof(*copy)) : NULL;

	if (!copy)
		return;
	*copy = *event;
	writer_add(w, (struct history_row){.kind = ROW_EVENT,
	                                   .us = event->time_ns / NS_PER_US,
	                                   .event = copy,
	                                   .key = w->table[event->signal]});
}

void history_writer_clock(struct history_writer *w, int64_t now_ns, int64_t offset_ns, bool trusted)
{
	if (offset_ns / NS_PER_US == w->offset_us && trusted == w->trusted)
		return;
	w->offset_us = offset_ns / NS_PER_US;
	w->trusted = trusted;
	writer_add(w,
	           (struct history_row){.kind = ROW_CLOCK, .us = now_ns / NS_PER_US, .key = ALL});
}

/*
 * --- To the file -------------------------------------------------------------------------------
 */

/* All values that hold, again: those that have no row for an hour, or all of them. */
static void repeat_values(struct history_writer *w, int64_t now_us, bool all)
{
	for (uint32_t i = 0; i < w->key_count; i++)
		if (w->kept[i].known && (all || now_us - w->kept[i].row_us >= REPEAT_US))
			add_value_row(w, i, now_us);
	w->repeat_us = now_us;
}

static void note_commit(struct history_writer *w, int err, int64_t now_us)
{
	w->error = err;
	if (!err) {
		w->step_us = 0;
		w->flushed_us = now_us;
		return;
	}
	w->step_us = w->step_us ? 2 * w->step_us : RETRY_US;
	if (w->step_us > RETRY_MOST_US)
		w->step_us = RETRY_MOST_US;
	w->retry_us = now_us + w->step_us;
}

/* Commit all rows up to a time. */
static int commit_rows(struct history_writer *w, int64_t now_us, int64_t until_us)
{
	struct store_batch batch = {
		.keys = w->keys,
		.key_count = w->key_count,
		.rows = w->rows,
		.begin_us = w->begin_us,
		.seen_us = until_us < INT64_MAX ? until_us : now_us,
		.offset_us = w->offset_us,
		.trusted = w->trusted,
	};
	uint32_t files;
	int err;

	sort_rows(w);
	while (batch.count < w->row_count && w->rows[batch.count].us <= until_us)
		batch.count++;
	err = store_commit(&w->store, &batch);
	note_commit(w, err, now_us);
	if (err)
		return err;
	remove_rows(w, batch.count);
	files = w->store.begun + (w->store.begun && !w->store.start);
	if (w->files && files != w->files)
		repeat_values(w, now_us,
		              true); /* another file, which has nothing of what was before */
	w->files = files;
	return 0;
}

int history_writer_tick(struct history_writer *w, int64_t now_ns)
{
	int64_t now_us = now_ns / NS_PER_US;
	bool full = w->row_count > w->row_most / 4 || w->text_bytes > w->text_most / 4;

	if (now_us - w->repeat_us >= MINUTE_US)
		repeat_values(w, now_us, false);
	if (w->error) {
		if (now_us < w->retry_us)
			return w->error;
	} else if (!full && now_us - w->flushed_us < w->flush_us) {
		return 0;
	}
	if (!w->row_count && !w->error && !store_is_due(&w->store, now_us - LATE_US))
		return 0;
	return commit_rows(w, now_us, now_us - LATE_US);
}

int history_writer_flush(struct history_writer *w, int64_t now_ns)
{
	return commit_rows(w, now_ns / NS_PER_US, now_ns / NS_PER_US);
}

int history_writer_close(struct history_writer *w, int64_t now_ns)
{
	int err = 0;

	if (!w)
		return 0;
	if (w->files || w->row_count) {
		gap_of_all(w, now_ns / NS_PER_US, now_ns / NS_PER_US, OWS_HISTORY_STOPPED);
		err = commit_rows(w, now_ns / NS_PER_US, INT64_MAX);
	}
	store_close(&w->store);
	remove_rows(w, w->row_count);
	for (uint32_t i = 0; i < w->key_count; i++)
		free(w->kept[i].text);
	free(w->rows);
	free(w->keys);
	free(w->kept);
	free(w->table);
	free(w->directory);
	free(w);
	return err;
}

int history_writer_known(struct history_writer *w, int64_t *alarms_ns, int64_t *commands_ns)
{
	int err = store_known(&w->store, alarms_ns, commands_ns);

	if (err)
		note_commit(w, err, w->flushed_us);
	return err;
}

void history_writer_state(const struct history_writer *w, struct history_state *state)
{
	*state = (struct history_state){
		.error = w->error,
		.waiting = (uint32_t)(w->row_count * sizeof(*w->rows) + w->text_bytes),
		.dropped = w->dropped,
		.rows = w->store.rows,
		.commits = w->store.commits,
		.files = w->files,
	};
}
