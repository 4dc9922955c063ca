/* SPDX-License-Identifier: MIT */
/* What is to be told. */
#include <fnmatch.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "src/config/read/texts.h"
#include "src/faces/notify/queue.h"

bool rules_critical(const struct ows_alarm *alarm)
{
	return alarm->event != OWS_ALARM_FAILED &&
	       (alarm->kind == OWS_ALARM_HH || alarm->kind == OWS_ALARM_LL ||
	        alarm->kind == OWS_ALARM_DEVICE || alarm->kind == OWS_ALARM_POR);
}

bool rules_of_limit(uint8_t kind)
{
	return kind >= OWS_ALARM_HH && kind <= OWS_ALARM_BAD;
}

bool rules_urgent(const struct ows_alarm *alarm)
{
	return alarm->event == OWS_ALARM_RAISED && rules_critical(alarm);
}

bool rules_chosen(const char *patterns, const char *name)
{
	char pattern[256];
	/* a list that only takes out means all others */
	bool chosen = patterns[strspn(patterns, ", ")] == '!';

	for (const char *one = patterns + strspn(patterns, ", "); *one; one += strspn(one, ", ")) {
		int len = (int)strcspn(one, ", ");
		bool out = *one == '!';

		snprintf(pattern, sizeof(pattern), "%.*s", len - out, one + out);
		if (!fnmatch(pattern, name, 0))
			chosen = !out;
		one += len;
	}
	return chosen;
}

bool rules_quiet(const char *hours, unsigned minute)
{
	unsigned from, until;

	if (!hours || !text_hours(hours, &from, &until))
		return false;
	return from < until ? minute >= from && minute < until : minute >= from || minute < until;
}

/* --- The queue ------------------------------------------------------------------------------- */

/* It is there. */
static const struct entry *entry_of(const struct queue *queue, uint64_t number)
{
	return &queue->entries[number % QUEUE_ENTRIES];
}

uint64_t queue_leaves(const struct queue *queue)
{
	if (queue->end - queue->first < QUEUE_ENTRIES)
		return queue->end;
	for (uint64_t n = queue->first; n < queue->end; n++)
		if (!entry_of(queue, n)->critical)
			return n;
	return queue->first;
}

struct entry *queue_add(struct queue *queue)
{
	uint64_t leaves = queue_leaves(queue);
	struct entry *entry;

	if (leaves < queue->end) {
		for (; leaves > queue->first; leaves--)
			queue->entries[leaves % QUEUE_ENTRIES] = *entry_of(queue, leaves - 1);
		queue->first++;
	}
	entry = &queue->entries[queue->end++ % QUEUE_ENTRIES];
	*entry = (struct entry){0};
	return entry;
}

struct entry *queue_at(struct queue *queue, uint64_t number)
{
	return number >= queue->first && number < queue->end
	               ? &queue->entries[number % QUEUE_ENTRIES]
	               : NULL;
}

int64_t queue_oldest(const struct queue *queue, uint64_t number, bool escalated)
{
	int64_t oldest = INT64_MAX;

	if (number < queue->first)
		number = queue->first;
	for (; number < queue->end; number++) {
		const struct entry *entry = entry_of(queue, number);

		if (entry->escalated == escalated && entry->entered_ns &&
		    entry->entered_ns < oldest)
			oldest = entry->entered_ns;
	}
	return oldest;
}

void queue_ended(struct queue *queue, int signal, uint8_t kind, const char *how, int64_t ended_ns)
{
	for (uint64_t n = queue->first; n < queue->end; n++) {
		struct entry *entry = &queue->entries[n % QUEUE_ENTRIES];
		bool same = entry->kind == kind ||
		            (rules_of_limit(entry->kind) && rules_of_limit(kind));

		if (entry->signal != signal || !entry->kind || !same || entry->ended_ns)
			continue;
		entry->ended = how;
		entry->ended_ns = ended_ns;
	}
}
