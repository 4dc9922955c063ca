/* SPDX-License-Identifier: MIT */
/* What signals have, and when rows go to the file. */
#include "src/history/file/writer.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/history/file/rows.h"
#include "src/history/file/schema.h"
#include "src/history/file/store.h"

#define NS_PER_US 1000
#define SECOND_US INT64_C(1000000)
#define FLUSH_US (10 * MINUTE_US)
/* Who has a long Flush has it for the card: so much in the file is worth a commit a minute */
#define ENOUGH (64u << 10)
#define ROW_BYTES 27
/* What is no value goes to the file at once, and no more often than that */
#define URGENT_US (10 * SECOND_US)
#define MEMORY (4u << 20)
/* Values of the same time reach the recorder one after the other: so long they wait for others */
#define LATE_US SECOND_US
#define RETRY_US SECOND_US
#define RETRY_MOST_US (60 * SECOND_US)

/* What a signal has, beside its key. */
struct kept {
	int64_t us; /* of its last row, which may repeat a value; nothing older comes after it */
	int64_t value;
	char *text;
	uint8_t quality, type;
	bool known, gap; /* gap: a row says that it is not known, since the last value */
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
	struct history_rows rows;
	int64_t offset_us;
	bool trusted;
	int64_t newest_us; /* no gap of all begins before it: of all rows, and after a value */
	int64_t floor_us;  /* the end of the last gap of all */
	int64_t begin_us, flushed_us, retry_us, step_us, repeat_us;
	int64_t urgent_us; /* of the oldest row that is no value; INT64_MAX: none */
	uint32_t files;    /* begun so far; another number: the present one has nothing of before */
	int error;
};

int history_writer_open(const struct history_options *options, int64_t now_ns, int64_t offset_ns,
                        bool trusted, struct history_writer **writer)
{
	uint32_t bytes = options->memory_bytes ? options->memory_bytes : MEMORY;
	struct history_writer *w = calloc(1, sizeof(*w));

	*writer = NULL;
	if (!w)
		return -ENOMEM;
	w->directory = strdup(options->directory);
	if (rows_open(&w->rows, bytes) || !w->directory) {
		rows_close(&w->rows);
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
	w->urgent_us = INT64_MAX;
	w->offset_us = offset_ns / NS_PER_US;
	w->trusted = trusted;
	*writer = w;
	return 0;
}

static void writer_add(struct history_writer *w, struct history_row row)
{
	rows_add(&w->rows, row, w->key_count);
	if (row.us >= w->newest_us && row.kind != ROW_EVENT)
		w->newest_us = row.us + (row.kind == ROW_VALUE);
	if (row.kind != ROW_VALUE && row.us < w->urgent_us)
		w->urgent_us = row.us;
}

/* --- What the recorder says ------------------------------------------------------------------ */

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

	/* a gap is deleted after all values before it */
	if (!kept->known && kept->gap)
		return;
	if (us < kept->us)
		us = kept->us;
	kept->us = us;
	kept->known = false;
	kept->gap = true;
	writer_add(w,
	           (struct history_row){.kind = ROW_GAP, .us = us, .key = key, .reason = reason});
}

/* The key of each signal, which may be a new one. Returns how many keys there are then. */
static uint32_t find_keys(const struct history_writer *w, const struct history_signal *signals,
                          uint32_t count, uint32_t *table)
{
	uint32_t keys = w->key_count;

	for (uint32_t i = 0; i < count; i++) {
		int at = find_key(w, history_identity(&signals[i]), w->key_count,
		                  i < w->count ? w->table[i] : 0);

		table[i] = at < 0 ? keys++ : (uint32_t)at;
	}
	return keys;
}

int history_writer_signals(struct history_writer *w, const struct history_signal *signals,
                           uint32_t count, int64_t now_ns)
{
	uint32_t *table = calloc(count + 1, sizeof(*table));
	bool *there = calloc(w->key_count + count + 1, sizeof(*there));
	int err = table && there ? room_for_keys(w, w->key_count + count) : -ENOMEM;

	if (!err && find_keys(w, signals, count, table) > HISTORY_SIGNALS)
		err = -E2BIG;
	for (uint32_t i = 0; !err && i < count; i++) {
		uint32_t at = table[i];

		if (at == w->key_count) {
			w->key_count++;
			w->kept[at] = (struct kept){.us = w->floor_us};
			w->keys[at] = (struct history_key){0};
		}
		set_key(&w->keys[at], &signals[i]);
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
	                                   .key = ROW_OF_ALL,
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
	w->urgent_us = now_ns / NS_PER_US; /* that a run begins, and what it finds */
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

	if (us > kept->us)
		kept->us = us;
	writer_add(w, (struct history_row){
			      .kind = ROW_VALUE,
			      .us = kept->us,
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
	free(kept->text);
	kept->type = w->keys[w->table[signal]].type;
	kept->text = kept->type == OWS_STRING && text ? strndup(text, len) : NULL;
	kept->value = value;
	kept->quality = quality;
	kept->known = true;
	kept->gap = false;
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
	writer_add(w, (struct history_row){.kind = ROW_CLOCK,
	                                   .us = now_ns / NS_PER_US,
	                                   .value = offset_ns / NS_PER_US - w->offset_us,
	                                   .key = ROW_OF_ALL});
	w->offset_us = offset_ns / NS_PER_US;
	w->trusted = trusted;
}

/* --- To the file ----------------------------------------------------------------------------- */

/* All values that hold, again: those that have no row for an hour, or all of them. */
static void repeat_values(struct history_writer *w, int64_t now_us, bool all)
{
	for (uint32_t i = 0; i < w->key_count; i++)
		if (w->kept[i].known && (all || now_us - w->kept[i].us >= REPEAT_US))
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
		.rows = w->rows.rows,
		.begin_us = w->begin_us,
		.seen_us = until_us < INT64_MAX ? until_us : now_us,
		.offset_us = w->offset_us,
		.trusted = w->trusted,
	};
	uint32_t files;
	int err;

	rows_sort(&w->rows);
	while (batch.count < w->rows.count && w->rows.rows[batch.count].us <= until_us)
		batch.count++;
	err = store_commit(&w->store, &batch);
	note_commit(w, err, now_us);
	if (err)
		return err;
	rows_remove(&w->rows, batch.count);
	w->urgent_us = INT64_MAX;
	for (uint32_t i = w->rows.count; i--;)
		if (w->rows.rows[i].kind != ROW_VALUE)
			w->urgent_us = w->rows.rows[i].us;
	files = w->store.begun + (w->store.begun && !w->store.start);
	if (w->files && files != w->files)
		repeat_values(w, now_us,
		              true); /* another file, which has nothing of what was before */
	w->files = files;
	return 0;
}

static bool is_worth_a_commit(const struct history_writer *w, int64_t now_us)
{
	int64_t since_us = now_us - w->flushed_us;

	if (w->rows.count > w->rows.most / 4 || w->rows.text_bytes > w->rows.text_most / 4)
		return true;
	if (w->urgent_us <= now_us - LATE_US && since_us >= URGENT_US)
		return true;
	if (since_us >= MINUTE_US && w->rows.count * ROW_BYTES + w->rows.text_bytes >= ENOUGH)
		return true;
	return since_us >= w->flush_us;
}

int history_writer_tick(struct history_writer *w, int64_t now_ns)
{
	int64_t now_us = now_ns / NS_PER_US;

	if (now_us - w->repeat_us >= MINUTE_US)
		repeat_values(w, now_us, false);
	if (w->error) {
		if (now_us < w->retry_us)
			return w->error;
	} else if (!is_worth_a_commit(w, now_us)) {
		return 0;
	}
	if (!w->rows.count && !w->error && !store_is_due(&w->store, now_us - LATE_US))
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
	if (w->files || w->rows.count) {
		gap_of_all(w, now_ns / NS_PER_US, now_ns / NS_PER_US, OWS_HISTORY_STOPPED);
		err = commit_rows(w, now_ns / NS_PER_US, INT64_MAX);
	}
	store_close(&w->store);
	for (uint32_t i = 0; i < w->key_count; i++)
		free(w->kept[i].text);
	rows_close(&w->rows);
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
		.waiting = (uint32_t)(w->rows.count * sizeof(*w->rows.rows) + w->rows.text_bytes),
		.dropped = w->rows.dropped,
		.rows = w->store.rows,
		.commits = w->store.commits,
		.files = w->files,
	};
}
