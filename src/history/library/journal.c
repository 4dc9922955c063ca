/* SPDX-License-Identifier: MIT */
/* The journal of a history: commands, alarms, and what the recorder met. */
#include <errno.h>
#include <string.h>

#include "src/ground/signal/value.h"
#include "src/history/file/record.h"
#include "src/history/file/sql.h"
#include "src/history/library/open.h"
#include "src/history/library/steps.h"

/* Columns of H_EVENTS */
enum {
	ID,
	TIME,
	KIND,
	SIGNAL,
	TYPE,
	QUALITY,
	REASON,
	EVENT,
	VALUE,
	BEFORE,
	TEXT,
	SERIAL,
	UID,
	PID,
	PROGRAM,
	PERSON,
	UNTIL
};

int ows_history_events(struct ows_history *h, int64_t from_ns, int64_t until_ns, uint32_t kinds)
{
	memset(&h->list, 0, sizeof(h->list));
	h->list.on = true;
	h->list.session = -1;
	h->list.kinds = kinds ? kinds : ~0u;
	h->list.from_us = from_ns / NS_PER_US;
	h->list.until_us = until_ns / NS_PER_US;
	return 0;
}

static void copy_text(char *to, size_t size, sqlite3_stmt *from, int column)
{
	const char *text = (const char *)sqlite3_column_text(from, column);
	size_t len = text ? strnlen(text, size - 1) : 0;

	if (len)
		memcpy(to, text, len);
	to[len] = '\0';
}

static void journal_put_value(sqlite3_stmt *from, int column, uint8_t type, double *number,
                              int64_t *integer)
{
	*number = sqlite3_column_double(from, column);
	if (!value_is_float((enum ows_type)type))
		*integer = sqlite3_column_int64(from, column);
}

static int64_t column_id(sqlite3_stmt *from, int column)
{
	return handle_within(sqlite3_column_int64(from, column), -MOST_ID, MOST_ID);
}

static void journal_convert(const struct ows_history *h, const struct session *session,
                            sqlite3_stmt *from, struct ows_history_event *to)
{
	bool alarm, has_value = sqlite3_column_type(from, VALUE) != SQLITE_NULL;
	int64_t id = column_id(from, TIME);

	*to = (struct ows_history_event){
		.time_ns = handle_wall_us(session, id) * NS_PER_US,
		.boot_ns = handle_boot_us(session, id) * NS_PER_US,
		.signal = handle_signal(h, sqlite3_column_int64(from, SIGNAL)),
		.kind = (uint8_t)sqlite3_column_int(from, KIND),
		.reason = (uint8_t)sqlite3_column_int(from, REASON),
		.type = (uint8_t)sqlite3_column_int(from, TYPE),
		.quality = (uint8_t)sqlite3_column_int(from, QUALITY),
		.event = (uint8_t)sqlite3_column_int(from, EVENT),
		.trusted = session->trusted,
		.this_boot = session->boot == h->boot,
	};
	if (sqlite3_column_type(from, UNTIL) != SQLITE_NULL)
		to->until_ns = handle_wall_us(session, column_id(from, UNTIL)) * NS_PER_US;
	alarm = to->kind == OWS_HISTORY_ALARM;
	if (!alarm && to->kind != OWS_HISTORY_COMMAND)
		return;
	if (alarm) {
		to->alarm = to->reason;
		to->reason = 0;
		to->has_before = sqlite3_column_type(from, BEFORE) != SQLITE_NULL;
		to->has_after = has_value;
		journal_put_value(from, BEFORE, to->type, &to->before, &to->before_integer);
	}
	if (to->type != OWS_STRING)
		journal_put_value(from, VALUE, to->type, &to->number, &to->integer);
	copy_text(to->text, sizeof(to->text), from, TEXT);
	to->who.serial = (uint32_t)sqlite3_column_int64(from, SERIAL);
	to->who.uid = (uint32_t)sqlite3_column_int64(from, UID);
	to->who.pid = sqlite3_column_int(from, PID);
	copy_text(to->who.name, sizeof(to->who.name), from, PROGRAM);
	copy_text(to->who.person, sizeof(to->who.person), from, PERSON);
}

static bool is_wanted(const struct ows_history *h, const struct ows_history_event *event)
{
	return event->kind < 32 && (h->list.kinds & 1u << event->kind) &&
	       event->time_ns / NS_PER_US >= h->list.from_us &&
	       event->time_ns / NS_PER_US < h->list.until_us;
}

static void journal_take(struct ows_history *h, const struct ows_history_event *event)
{
	if (is_wanted(h, event))
		h->list.ready[h->list.count++] = *event;
}

/* Clamped, as the limits may be those of the type. */
static int64_t less(int64_t us, int64_t date)
{
	return us > INT64_MAX / 2000 ? us : us - date;
}

/* More of the run that is read, or of the next one. 1; 0: the end. */
static int journal_fill(struct ows_history *h)
{
	const int room = (int)(sizeof(h->list.ready) / sizeof(h->list.ready[0]));
	sqlite3_stmt *from = h->statements[H_EVENTS];
	const struct session *session;
	int got = 0;

	h->list.count = h->list.given = 0;
	if (h->list.session < 0 || h->list.next >= h->sessions[h->list.session].end) {
		if (h->list.session + 1 >= h->session_count)
			return 0;
		session = &h->sessions[++h->list.session];
		h->list.next = session->start;
		journal_take(h,
		             &(struct ows_history_event){
				     .time_ns = handle_wall_us(session, session->start) * NS_PER_US,
				     .boot_ns = handle_boot_us(session, session->start) * NS_PER_US,
				     .signal = -1,
				     .kind = OWS_HISTORY_BEGIN,
				     .reason = session->reason ? session->reason : OWS_HISTORY_LOST,
				     .trusted = session->trusted,
				     .this_boot = session->boot == h->boot,
			     });
	}
	session = &h->sessions[h->list.session];
	sql_bind(from, "iiii", h->list.next, session->end, less(h->list.from_us, session->date),
	         less(h->list.until_us, session->date));
	h->list.next = session->end;
	while (h->list.count < room && (got = sql_next(from)) == 1) {
		struct ows_history_event event;

		journal_convert(h, session, from, &event);
		journal_take(h, &event);
		if (h->list.count == room)
			h->list.next = sqlite3_column_int64(from, ID) + 1;
	}
	sqlite3_reset(from);
	return got < 0 ? got : 1;
}

int ows_history_next_event(struct ows_history *h, struct ows_history_event *event)
{
	int got = h->list.on ? 1 : -EINVAL;

	open_allow(h);
	while (got == 1 && h->list.given == h->list.count)
		got = journal_fill(h);
	if (got != 1)
		return got;
	*event = h->list.ready[h->list.given++];
	return 1;
}
