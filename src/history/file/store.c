/* SPDX-License-Identifier: MIT */
/* Commits of rows to the file of history. */
#include "src/history/file/store.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "src/ground/signal/value.h"
#include "src/history/file/schema.h"
#include "src/history/file/sql.h"

#define SEEN_US (10 * MINUTE_US) /* so often the file says that the recorder looks */

/* --- The file -------------------------------------------------------------------------------- */

void store_begin(struct history_store *store)
{
	store->file.lock = -1;
	store->gap_us = -1;
	store->sums.statements = store->statements;
	store->rolling.give = sums_give;
	store->rolling.ctx = &store->sums;
}

static void close_file(struct history_store *store)
{
	statements_close(store->statements);
	file_close(&store->file);
}

void store_close(struct history_store *store)
{
	close_file(store);
	rolling_free(&store->rolling);
	sums_free(&store->sums);
}

int store_ready(struct history_store *store)
{
	int err = 0;

	if (store->file.db && !file_is_there(&store->file)) {
		close_file(store);
		return -ENOENT;
	}
	if (store->file.db)
		return 0;
	store->stale = true;
	err = file_open(&store->file);
	if (!err)
		err = statements_open(store->file.db, store->statements);
	if (err)
		close_file(store);
	return err;
}

/* After an error nothing of the last commit is in the file, and little is known of it. */
static void store_fail(struct history_store *store, struct store_batch *batch, int err)
{
	for (uint32_t i = 0; i < batch->key_count; i++)
		batch->keys[i].number = 0;
	store->stale = true;
	store->gap_us = -1;
	if (!store->file.db)
		return;
	sql_run(store->statements[S_ROLLBACK], "");
	if (err == -ENOSPC || err == -EAGAIN || err == -ENOMEM)
		return;
	close_file(store);
	if (err == -EBADMSG)
		file_put_aside(&store->file);
}

/* --- What the file has ----------------------------------------------------------------------- */

static struct rollup_state state_of_value(uint8_t type, int64_t value, uint8_t quality)
{
	return (struct rollup_state){
		.value = type == OWS_STRING ? NAN : value_number((enum ows_type)type, value),
		.quality = quality,
		.known = true,
	};
}

/* The same of a column: a text, and null, which is what became of NaN, are no number. */
static struct rollup_state state_read(sqlite3_stmt *from)
{
	int type = sqlite3_column_type(from, 2);

	return (struct rollup_state){
		.value = type == SQLITE_INTEGER || type == SQLITE_FLOAT
	                         ? sqlite3_column_double(from, 2)
	                         : NAN,
		.quality = (uint8_t)sqlite3_column_int(from, 3),
		.known = true,
	};
}

/* The minute and the hour under way, of what the file has of them: so a restart loses nothing. */
static int replay(struct history_store *store)
{
	sqlite3_stmt *from = store->statements[S_REPLAY];
	int64_t since = 0;
	int got;

	got = sql_number(store->statements[S_SINCE], &since, "");
	if (got < 0)
		return got;
	sums_begin(&store->sums, since / HOUR_US);
	rolling_begin(&store->rolling, since - LOOK_BACK_US > 0 ? since - LOOK_BACK_US : 0);
	sql_bind(from, "i", since - LOOK_BACK_US);
	while ((got = sql_next(from)) == 1) {
		int64_t id = sqlite3_column_int64(from, 0);
		uint32_t signal = (uint32_t)sqlite3_column_int64(from, 1);
		struct rollup_state state = state_read(from);
		int err = sqlite3_column_type(from, 3) == SQLITE_NULL
		                  ? rolling_gap(&store->rolling, id, signal)
		                  : rolling_value(&store->rolling, id, signal, &state);

		if (err) {
			sqlite3_reset(from);
			return err == -E2BIG ? -EBADMSG : err;
		}
	}
	return got;
}

/* Has the file this run, and up to where does it go? */
static int read_place(struct history_store *store)
{
	int64_t ours = 0;
	int got;

	store->last_id = 0;
	got = sql_number(store->statements[S_LAST], &store->last_id, "");
	if (got >= 0)
		got = sql_number(store->statements[S_OURS], &ours, "ii", store->start, store->boot);
	if (got >= 0 && !ours)
		store->start = 0;
	got = got < 0 ? got : replay(store);
	store->stale = got < 0;
	return got < 0 ? got : 0;
}

/* --- What comes ------------------------------------------------------------------------------ */

static int add_gap(struct history_store *store, int64_t start, uint32_t signal, int64_t until,
                   uint8_t reason)
{
	sqlite3_stmt *to = store->statements[S_GAP];
	int err;

	sql_bind(to, "iini", start, (int64_t)signal, (int64_t)reason);
	if (until)
		sqlite3_bind_int64(to, 3, until);
	err = sql_next(to);
	return err ? err : rolling_gap(&store->rolling, start, signal);
}

/* This run begins in the file: what is between the last one and now is a gap. */
static int begin_run(struct history_store *store, const struct store_batch *batch)
{
	sqlite3_stmt *before = store->statements[S_BEFORE];
	int64_t us = batch->begin_us, start = us + batch->offset_us, last = store->last_id;
	bool any, same = false;
	int got = sql_run(before, "");

	if (got < 0)
		return got;
	any = got == 1;
	if (any && !batch->trusted) {
		same = sqlite3_column_int64(before, 1) == store->boot;
		start = same ? us + sqlite3_column_int64(before, 0) : last + 1;
	}
	sqlite3_reset(before);
	if (start <= last + 1)
		start = last + 2;
	got = sql_run(store->statements[S_END_GAP], "i", start);
	if (!got && any && !sqlite3_changes(store->file.db))
		got = add_gap(store, last + 1, 0, start, OWS_HISTORY_LOST);
	if (got)
		return got;
	store->start = start;
	store->last_id = start - 1;
	store->base = start - us;
	store->seen_us = us;
	store->begun++;
	return sql_run(store->statements[S_SESSION], "iiiii", start, store->boot, store->base,
	               batch->offset_us - store->base, (int64_t)batch->trusted);
}

static int name_key(struct history_store *store, struct history_key *key)
{
	static const enum statement both[] = {S_RENEW, S_NAME};
	int64_t number = 0;
	int got;

	if (key->number)
		return 0;
	got = sql_number(store->statements[S_FIND], &number, "tt", key->identity, key->name);
	if (got < 0)
		return got;
	got = sql_run(store->statements[S_TAKE], "ti", key->name, number);
	if (got)
		return got;
	got = sql_run(store->statements[both[!number]], number ? "ttiiiti" : "ttiiit", key->name,
	              key->unit, (int64_t)key->type, (int64_t)key->output, (int64_t)key->decimals,
	              key->identity, number);
	if (got)
		return got;
	if (!number)
		number = sqlite3_last_insert_rowid(store->file.db);
	if (number > HISTORY_SIGNALS)
		return -E2BIG;
	key->number = (uint32_t)number;
	return 0;
}

static void bind_value(sqlite3_stmt *to, int at, uint8_t type, int64_t value)
{
	if (value_is_float((enum ows_type)type))
		sqlite3_bind_double(to, at, value_number((enum ows_type)type, value));
	else
		sqlite3_bind_int64(to, at, value);
}

static int64_t next_id(const struct history_store *store, int64_t us)
{
	int64_t id = store->base + us;

	return id > store->last_id ? id : store->last_id + 1;
}

static int store_put_value(struct history_store *store, struct history_key *key,
                           const struct history_row *row)
{
	struct rollup_state state = state_of_value(row->type, row->value, row->quality);
	sqlite3_stmt *to = store->statements[S_VALUE];
	int64_t id = next_id(store, row->us);
	int err;

	sql_bind(to, "iini", id, (int64_t)key->number, (int64_t)row->quality);
	if (row->type == OWS_STRING)
		sqlite3_bind_text(to, 3, row->text ? row->text : "", -1, SQLITE_STATIC);
	else
		bind_value(to, 3, row->type, row->value);
	err = sql_next(to);
	if (!err)
		err = rolling_value(&store->rolling, id, key->number, &state);
	key->last_id = store->last_id = id;
	return err;
}

/* Of one signal it may reach back behind what is written, of all it does not. */
static int put_gap(struct history_store *store, struct history_key *key,
                   const struct history_row *row)
{
	int64_t start = store->base + row->us, until = store->base + row->value;

	if (key) {
		if (start <= key->last_id)
			start = key->last_id + 1;
		if (start <= store->start)
			start = store->start + 1;
		return add_gap(store, start, key->number, 0, row->reason);
	}
	if (row->us == store->gap_us && row->reason == store->gap_reason)
		return sql_run(store->statements[S_LONGER], "ii", until, store->gap_start);
	start = store->last_id = next_id(store, row->us);
	store->gap_us = row->us;
	store->gap_start = start;
	store->gap_reason = row->reason;
	if (row->reason == OWS_HISTORY_STOPPED)
		until = 0;
	else if (until < start)
		until = start;
	return add_gap(store, start, 0, until, row->reason);
}

static int put_event(struct history_store *store, const struct history_key *key,
                     const struct history_row *row)
{
	const struct history_event *event = row->event;
	sqlite3_stmt *to = store->statements[S_EVENT];
	int64_t id = next_id(store, row->us);
	bool who = event && event->who.serial;

	sql_bind(to, "iiinnnnnnnnnnnnn", id, store->base + row->us,
	         (int64_t)(event ? event->kind : OWS_HISTORY_CLOCK));
	store->last_id = id;
	if (!event)
		sqlite3_bind_double(to, 9, (double)row->value / 1e6);
	if (!event || !key)
		return event ? -EINVAL : sql_next(to);
	sqlite3_bind_int64(to, 4, key->number);
	sqlite3_bind_int(to, 5, event->type);
	sqlite3_bind_int(to, 6, event->quality);
	sqlite3_bind_int(to, 7, event->reason);
	sqlite3_bind_int(to, 8, event->event);
	if (event->has_value)
		bind_value(to, 9, event->type, event->value);
	if (event->has_before)
		bind_value(to, 10, event->type, event->before);
	sqlite3_bind_text(to, 11, event->text, -1, SQLITE_STATIC);
	if (who) {
		sqlite3_bind_int64(to, 12, event->who.serial);
		sqlite3_bind_int64(to, 13, event->who.uid);
		sqlite3_bind_int(to, 14, event->who.pid);
		sqlite3_bind_text(to, 15, event->who.name, -1, SQLITE_STATIC);
		sqlite3_bind_text(to, 16, event->who.person, -1, SQLITE_STATIC);
	}
	return sql_next(to);
}

static int put_row(struct history_store *store, struct store_batch *batch,
                   const struct history_row *row)
{
	struct history_key *key = row->key < batch->key_count ? &batch->keys[row->key] : NULL;
	int err = store->start ? 0 : begin_run(store, batch);

	if (!err && key)
		err = name_key(store, key);
	if (err)
		return err;
	switch ((enum history_row_kind)row->kind) {
	case ROW_VALUE:
		return key ? store_put_value(store, key, row) : -EINVAL;
	case ROW_GAP:
		return put_gap(store, key, row);
	case ROW_EVENT:
	case ROW_CLOCK:
		return put_event(store, key, row);
	}
	return -EINVAL;
}

/* Without rows the file says now and then that the recorder looks. */
static int put_seen(struct history_store *store, const struct store_batch *batch)
{
	int64_t id = store->base + batch->seen_us;
	int err = 0;

	if (!store->start || id <= store->last_id)
		return 0;
	if (batch->count == 0 && batch->seen_us - store->seen_us >= SEEN_US) {
		store->last_id = id;
		err = sql_run(store->statements[S_SEEN], "ii", id, store->start);
	}
	if (batch->count || batch->seen_us - store->seen_us >= SEEN_US)
		store->seen_us = batch->seen_us;
	return err ? err : rolling_advance(&store->rolling, id);
}

bool store_is_due(const struct history_store *store, int64_t seen_us)
{
	return store->start && !store->stale &&
	       (seen_us - store->seen_us >= SEEN_US ||
	        rolling_is_due(&store->rolling, store->base + seen_us));
}

int store_commit(struct history_store *store, struct store_batch *batch)
{
	int err = store_ready(store);
	uint32_t files = store->begun;
	bool begun = false;

	if (!err) {
		err = sql_run(store->statements[S_BEGIN], "");
		begun = !err;
	}
	if (!err && store->stale)
		err = read_place(store);
	for (uint32_t i = 0; !err && i < batch->count; i++)
		err = put_row(store, batch, &batch->rows[i]);
	if (!err)
		err = put_seen(store, batch);
	if (!err)
		err = sql_run(store->statements[S_DATE], "iii", batch->offset_us,
		              (int64_t)batch->trusted, store->boot);
	if (!err)
		err = keep_delete(&store->keep, store->file.db, store->file.directory,
		                  store->last_id);
	if (!err && begun)
		err = sql_run(store->statements[S_COMMIT], "");
	if (err) {
		store_fail(store, batch, err);
		store->begun = files;
	} else {
		store->commits++, store->rows += batch->count;
	}
	return err;
}

int store_known(struct history_store *store, int64_t *alarms_ns, int64_t *commands_ns)
{
	static const int kinds[] = {OWS_HISTORY_ALARM, OWS_HISTORY_COMMAND};
	int64_t *to[] = {alarms_ns, commands_ns};
	int err = store_ready(store);

	for (int i = 0; i < 2; i++) {
		int64_t us = -1;

		*to[i] = 0;
		if (err)
			continue;
		if (sql_number(store->statements[S_KNOWN], &us, "ii", store->boot,
		               (int64_t)kinds[i]) < 0)
			err = -EIO;
		if (!err && us >= 0)
			*to[i] = us * 1000 + 999;
	}
	return err;
}

void history_key_leave(struct history_key *key, const struct history_signal *signals,
                       uint32_t count)
{
	size_t size = strlen(key->identity) + 1;

	for (uint32_t i = 0; i < count && size <= sizeof(key->name); i++)
		if (!strcmp(signals[i].name, key->name)) {
			memcpy(key->name, key->identity, size);
			return;
		}
}
