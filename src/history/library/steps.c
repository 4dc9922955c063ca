/* SPDX-License-Identifier: MIT */
/* The signals of a history, and the values of one of them. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/ground/signal/value.h"
#include "src/history/file/record.h"
#include "src/history/file/schema.h"
#include "src/history/file/sql.h"
#include "src/history/library/open.h"
#include "src/history/library/steps.h"

const char *ows_history_reason_text(uint8_t reason)
{
	return history_reason_text(reason);
}

int ows_history_signals(struct ows_history *h)
{
	return h->signal_count;
}

int ows_history_signal(struct ows_history *h, int index, struct ows_history_signal *signal)
{
	const struct known_signal *known;

	if (index < 0 || index >= h->signal_count)
		return -EINVAL;
	known = &h->signals[index];
	*signal = (struct ows_history_signal){
		.name = known->name,
		.unit = known->unit,
		.type = known->type,
		.output = known->output,
		.decimals = known->decimals,
		.identity = known->identity,
	};
	return 0;
}

int ows_history_find(struct ows_history *h, const char *name)
{
	char former[HISTORY_NAME + 3];

	for (int i = 0; i < h->signal_count; i++)
		if (strcmp(h->signals[i].name, name) == 0)
			return i;
	snprintf(former, sizeof(former), " %.*s ", HISTORY_NAME, name);
	for (int i = h->signal_count - 1; i >= 0; i--)
		if (*name && (strcmp(h->signals[i].identity, name) == 0 ||
		              strstr(h->signals[i].former, former)))
			return i;
	return -ENOENT;
}

int handle_signal(const struct ows_history *h, int64_t number)
{
	for (int i = 0; i < h->signal_count; i++)
		if (h->signals[i].number == number)
			return i;
	return -1;
}

/* --- Steps ----------------------------------------------------------------------------------- */

int steps_take(sqlite3_stmt *from, const struct known_signal *signal, struct step *step)
{
	bool whole = !value_is_float((enum ows_type)signal->type) && signal->type != OWS_STRING;
	const char *text;

	*step = (struct step){.id = sqlite3_column_int64(from, 0), .number = NAN};
	step->known = sqlite3_column_type(from, 3) == SQLITE_NULL;
	step->type = signal->type;
	if (!step->known) {
		step->reason = (uint8_t)sqlite3_column_int(from, 3);
		return 0;
	}
	step->quality = (uint8_t)sqlite3_column_int(from, 2);
	switch (sqlite3_column_type(from, 1)) {
	case SQLITE_INTEGER:
		step->type = whole ? signal->type : OWS_LARGE;
		step->integer = sqlite3_column_int64(from, 1);
		step->number = (double)step->integer;
		break;
	case SQLITE_FLOAT:
		step->type = whole || signal->type == OWS_STRING ? OWS_DOUBLE : signal->type;
		step->number = sqlite3_column_double(from, 1);
		break;
	case SQLITE_TEXT:
		step->type = OWS_STRING;
		text = (const char *)sqlite3_column_text(from, 1);
		step->text = strdup(text ? text : "");
		return step->text ? 0 : -ENOMEM;
	default: /* NaN */
		break;
	}
	return 0;
}

int handle_held(struct ows_history *h, const struct known_signal *signal, int64_t id,
                struct step *step)
{
	sqlite3_stmt *raw = h->statements[H_RAW], *gap = h->statements[H_GAPS];
	struct step unknown = {.id = INT64_MIN};
	int got = sql_run(gap, "ii", id, (int64_t)signal->number);

	if (got == 1)
		got = steps_take(gap, signal, &unknown);
	sqlite3_reset(gap);
	if (got < 0)
		return got;
	got = sql_run(raw, "iii", id, id - LOOK_BACK_US, (int64_t)signal->number);
	if (got == 1) {
		got = steps_take(raw, signal, step);
		got = got < 0 ? got : 1;
	}
	sqlite3_reset(raw);
	if (got == 1 && unknown.id > step->id) {
		free(step->text);
		got = 0;
	}
	if (got != 1)
		*step = (struct step){.number = NAN};
	return got;
}

int handle_steps(struct ows_history *h, const struct known_signal *signal, int64_t first,
                 int64_t end, struct step *steps, int room)
{
	sqlite3_stmt *from = h->statements[H_STEPS];
	int count = 0, got;

	sql_bind(from, "iiii", first, end, (int64_t)signal->number, (int64_t)room);
	while (count < room && (got = sql_next(from)) == 1) {
		int err = steps_take(from, signal, &steps[count]);

		if (err) {
			got = err;
			break;
		}
		count++;
	}
	sqlite3_reset(from);
	if (count < room && got < 0) {
		for (int i = 0; i < count; i++)
			free(steps[i].text);
		return got;
	}
	return count;
}

/* --- Items ----------------------------------------------------------------------------------- */

int ows_history_read(struct ows_history *h, int signal, int64_t from_ns, int64_t until_ns)
{
	for (int i = h->read.given; i < h->read.count; i++)
		free(h->read.ready[i].text);
	h->read.on = false;
	h->read.count = h->read.given = 0;
	if (signal < 0 || signal >= h->signal_count)
		return -EINVAL;
	h->read.on = true;
	h->read.holds = h->read.ended = false;
	h->read.signal = signal;
	h->read.session = -1;
	h->read.from_us = from_ns / NS_PER_US;
	h->read.until_us = until_ns / NS_PER_US;
	return 0;
}

/* Go to the next run that has something, and to what held there. 1; 0: there is none. */
static int next_session(struct ows_history *h)
{
	int64_t end;

	for (int i = h->read.session + 1; i < h->session_count; i++) {
		const struct session *session = &h->sessions[i];

		if (!handle_range(session, h->read.from_us, h->read.until_us, &h->read.next, &end))
			continue;
		h->read.session = i;
		h->read.count = h->read.given = 0;
		if (h->read.next > session->start) {
			int got = handle_held(h, &h->signals[h->read.signal], h->read.next,
			                      &h->read.ready[0]);

			if (got < 0)
				return got;
			h->read.count = got;
			h->read.next++;
		}
		return 1;
	}
	return 0;
}

/* More steps, or the next run: 1; 0: the end. */
static int steps_fill(struct ows_history *h)
{
	const struct session *session;
	int64_t first, end;
	int got;

	while (h->read.given == h->read.count) {
		if (h->read.session < 0) {
			got = next_session(h);
			if (got != 1)
				return got;
			continue;
		}
		session = &h->sessions[h->read.session];
		handle_range(session, h->read.from_us, h->read.until_us, &first, &end);
		got = handle_steps(h, &h->signals[h->read.signal], h->read.next, end, h->read.ready,
		                   READY);
		if (got < 0)
			return got;
		h->read.given = 0;
		h->read.count = got;
		if (got) {
			h->read.next = h->read.ready[got - 1].id + 1;
			break;
		}
		got = next_session(h);
		if (got != 1)
			return got;
	}
	return 1;
}

static void steps_convert(struct ows_history *h, const struct step *step,
                          struct ows_history_item *item)
{
	/* what held at the begin may be of a run before */
	int i = h->read.session;

	while (i > 0 && step->id < h->sessions[i].start)
		i--;
	*item = (struct ows_history_item){
		.time_ns = handle_wall_us(&h->sessions[i], step->id) * NS_PER_US,
		.boot_ns = handle_boot_us(&h->sessions[i], step->id) * NS_PER_US,
		.number = step->number,
		.integer = value_is_float((enum ows_type)step->type) ? 0 : step->integer,
		.text = step->text,
		.len = step->text ? (uint32_t)strlen(step->text) : 0,
		.known = step->known,
		.type = step->type,
		.quality = step->quality,
		.reason = step->reason,
		.trusted = h->sessions[i].trusted,
	};
	free(h->read.text);
	h->read.text = step->text;
}

/* One item: 1, 0 at the end. */
static int next_item(struct ows_history *h, struct ows_history_item *item)
{
	const struct step *step;
	int got;

	for (;;) {
		got = steps_fill(h);
		if (got != 1)
			break;
		step = &h->read.ready[h->read.given++];
		/* of what is not known anyway a gap is no news */
		if (!step->known && !h->read.holds)
			continue;
		h->read.holds = step->known;
		steps_convert(h, step, item);
		return 1;
	}
	/* the file does not say what came then */
	if (got == 0 && h->read.holds && !h->read.ended) {
		const struct session *last = &h->sessions[h->session_count - 1];

		h->read.ended = true;
		if (h->end + last->date >= h->read.until_us - 1)
			return 0;
		h->read.session = h->session_count - 1;
		steps_convert(h,
		              &(struct step){.id = h->end + 1,
		                             .number = NAN,
		                             .type = h->signals[h->read.signal].type},
		              item);
		return 1;
	}
	return got;
}

int ows_history_next(struct ows_history *h, struct ows_history_item *items, int n)
{
	int count = 0, got = 0;

	if (!h->read.on || n < 1)
		return -EINVAL;
	open_allow(h);
	while (count < n) {
		got = next_item(h, &items[count]);
		if (got != 1)
			break;
		/* the text stays until the next call alone */
		if (items[count++].text)
			break;
	}
	return count ? count : got;
}
