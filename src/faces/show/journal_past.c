/* SPDX-License-Identifier: MIT */
/* Reads the journal on disk, and finds which of its entries owsd still has in memory. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/show/journal_past.h"
#include "src/faces/show/names.h"

#define FIRST 64

/* The last entries that were read, oldest first from `at` on. */
struct reading {
	struct ows_history *history;
	const struct when *now;
	char *const *patterns;
	int count;
	unsigned most, size, at;
	uint32_t number;
	struct journal_entries *to;
};

static struct ows_by past_by(const struct ows_history_who *who)
{
	struct ows_by by = {.serial = who->serial, .uid = who->uid, .pid = who->pid};

	snprintf(by.name, sizeof(by.name), "%.*s", (int)sizeof(who->name) - 1, who->name);
	snprintf(by.person, sizeof(by.person), "%.*s", (int)sizeof(who->person) - 1, who->person);
	return by;
}

static struct journal_entry journal_past_convert(const struct reading *r,
                                                 const struct ows_history_event *event,
                                                 const struct ows_history_signal *signal)
{
	const struct when *now = r->now;
	struct journal_entry entry = {
		.when_ns = event->this_boot ? event->boot_ns
	                                    : now->boot - (now->wall - event->time_ns),
		.name = signal->name,
		.decimals = signal->decimals,
		.signal = -1,
		.number = r->number,
		.past = true,
		.this_boot = event->this_boot,
		.is_command = event->kind == OWS_HISTORY_COMMAND,
	};

	if (entry.is_command) {
		entry.command = (struct ows_commanded){
			.signal = -1,
			.taken_ns = entry.when_ns,
			.number = event->number,
			.integer = event->integer,
			.type = event->type,
			.reason = event->reason,
			.quality = event->quality,
			.who = past_by(&event->who),
		};
		snprintf(entry.command.text, sizeof(entry.command.text), "%.*s",
		         (int)sizeof(entry.command.text) - 1, event->text);
		return entry;
	}
	entry.alarm = (struct ows_alarm){
		.signal = -1,
		.occurred_ns = entry.when_ns,
		.before = event->before,
		.after = event->number,
		.before_integer = event->before_integer,
		.after_integer = event->integer,
		.type = event->type,
		.has_before = event->has_before,
		.has_after = event->has_after,
		.kind = event->alarm,
		.event = event->event,
		.quality = event->quality,
		.who = past_by(&event->who),
	};
	snprintf(entry.alarm.text, sizeof(entry.alarm.text), "%.*s",
	         (int)sizeof(entry.alarm.text) - 1, event->text);
	return entry;
}

/* The place for one more entry: a new one, or that of the oldest. NULL: no memory. */
static struct journal_entry *next_entry(struct reading *r)
{
	struct journal_entries *to = r->to;
	struct journal_entry *more;

	if (to->count == r->most) {
		r->at = (r->at + 1) % r->most;
		return &to->entry[(r->at + r->most - 1) % r->most];
	}
	if (to->count == r->size) {
		r->size = r->size ? 2 * r->size : FIRST;
		more = realloc(to->entry, r->size * sizeof(*more));
		if (!more)
			return NULL;
		to->entry = more;
	}
	return &to->entry[to->count++];
}

static int journal_past_take(struct reading *r, const struct ows_history_event *event)
{
	struct ows_history_signal signal = {.name = "?", .unit = "", .decimals = -1};
	struct journal_entry *entry;

	if (event->signal >= 0)
		ows_history_signal(r->history, event->signal, &signal);
	if (!names_match(signal.name, r->patterns, r->count) || !r->most)
		return 0;
	entry = next_entry(r);
	if (!entry)
		return -ENOMEM;
	*entry = journal_past_convert(r, event, &signal);
	r->number++;
	return 0;
}

static int read_from(struct reading *r, int64_t from_ns, int64_t until_ns)
{
	struct ows_history_event event;
	int err = ows_history_events(r->history, from_ns, until_ns,
	                             1u << OWS_HISTORY_COMMAND | 1u << OWS_HISTORY_ALARM);
	int got = 0;

	while (!err && (got = ows_history_next_event(r->history, &event)) == 1)
		err = journal_past_take(r, &event);
	return err ? err : got;
}

int journal_past(struct ows_history *history, const struct when *now, int64_t from_ns,
                 int64_t until_ns, char *const *patterns, int count, unsigned most,
                 struct journal_entries *past)
{
	struct reading r = {.history = history,
	                    .now = now,
	                    .patterns = patterns,
	                    .count = count,
	                    .most = most,
	                    .to = past};
	int err;

	*past = (struct journal_entries){0};
	err = read_from(&r, from_ns, until_ns);
	if (err)
		journal_free(past);
	else if (past->count)
		qsort(past->entry, past->count, sizeof(*past->entry), journal_order);
	return err;
}

static bool is_same(const struct journal_entry *past, const struct journal_entry *entry)
{
	if (past->is_command != entry->is_command || !past->this_boot ||
	    past->when_ns / NS_PER_MS != entry->when_ns / NS_PER_MS ||
	    strcmp(past->name, entry->name) != 0)
		return false;
	if (past->is_command)
		return past->command.reason == entry->command.reason;
	return past->alarm.kind == entry->alarm.kind && past->alarm.event == entry->alarm.event;
}

/* Mark the newest entry that is the same and not marked yet. */
static bool is_among(const struct journal_entry *past, const struct journal_entries *entries,
                     bool *marked)
{
	for (unsigned i = entries->count; i-- > 0;) {
		if (marked[i] || !is_same(past, &entries->entry[i]))
			continue;
		marked[i] = true;
		return true;
	}
	return false;
}

bool journal_past_drop(struct journal_entries *past, const struct journal_entries *entries)
{
	bool *marked = calloc(entries->count + 1u, sizeof(*marked));
	unsigned kept = past->count;

	if (!marked)
		return false;
	for (unsigned i = past->count; i-- > 0;)
		if (!is_among(&past->entry[i], entries, marked))
			past->entry[--kept] = past->entry[i];
	if (kept)
		memmove(past->entry, past->entry + kept,
		        (past->count - kept) * sizeof(*past->entry));
	past->count -= kept;
	free(marked);
	return true;
}
