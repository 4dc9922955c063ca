/* SPDX-License-Identifier: MIT */
/* Reads the two journals, merges them by time, and shows an entry as JSON. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/show/actor.h"
#include "src/faces/show/digits.h"
#include "src/faces/show/journal_entry.h"
#include "src/faces/show/names.h"

/* --- Reading --------------------------------------------------------------------------------- */

static int get_alarm(struct ows *h, uint32_t number, struct journal_entry *entry)
{
	int err = ows_alarm(h, number, &entry->alarm);

	entry->when_ns = entry->alarm.occurred_ns;
	entry->signal = entry->alarm.signal;
	return err;
}

static int get_command(struct ows *h, uint32_t number, struct journal_entry *entry)
{
	int err = ows_command_entry(h, number, &entry->command);

	entry->is_command = true;
	entry->when_ns = entry->command.taken_ns;
	entry->signal = entry->command.signal;
	return err;
}

typedef int journal_get(struct ows *h, uint32_t number, struct journal_entry *entry);

/* The oldest entry that is kept, but not one before `from`. */
static uint32_t first_kept(struct ows *h, journal_get *get, uint32_t head, const uint32_t *from)
{
	struct journal_entry entry;
	uint32_t first = head;

	while ((!from || first != *from) && get(h, first - 1, &entry) != -ENOENT)
		first--;
	return first;
}

static bool is_wanted(struct ows *h, struct journal_entry *entry, char *const *patterns, int count)
{
	struct ows_info info;

	if (ows_info(h, entry->signal, &info) || !names_match(info.name, patterns, count))
		return false;
	entry->name = info.name;
	entry->decimals = info.decimals;
	return true;
}

/* Append the entries of one journal from *next on. */
static bool journal_entry_look(struct ows *h, journal_get *get, uint32_t head, uint32_t *next,
                               char *const *patterns, int count, struct journal_entries *entries)
{
	uint32_t number = first_kept(h, get, head, entries->begun ? next : NULL);
	struct journal_entry *more;

	more = realloc(entries->entry,
	               (entries->count + (size_t)(head - number) + 1) * sizeof(*more));
	if (!more)
		return false;
	entries->entry = more;
	for (; number != head; number++) {
		struct journal_entry *entry = &more[entries->count];

		*entry = (struct journal_entry){.number = number, .this_boot = true};
		if (get(h, number, entry) == 0 && is_wanted(h, entry, patterns, count))
			entries->count++;
	}
	*next = head;
	return true;
}

int journal_order(const void *one, const void *other)
{
	const struct journal_entry *a = one, *b = other;

	if (a->this_boot != b->this_boot)
		return a->this_boot ? 1 : -1;
	if (a->when_ns != b->when_ns)
		return a->when_ns < b->when_ns ? -1 : 1;
	if (a->past != b->past)
		return a->past ? -1 : 1;
	if (!a->past && a->is_command != b->is_command)
		return a->is_command ? 1 : -1;
	return (int32_t)(a->number - b->number);
}

bool journal_look(struct ows *h, char *const *patterns, int count, struct journal_entries *entries)
{
	entries->count = 0;
	if (!journal_entry_look(h, get_alarm, ows_alarm_count(h), &entries->next_alarm, patterns,
	                        count, entries) ||
	    !journal_entry_look(h, get_command, ows_command_count(h), &entries->next_command,
	                        patterns, count, entries))
		return false;
	entries->begun = true;
	qsort(entries->entry, entries->count, sizeof(*entries->entry), journal_order);
	return true;
}

bool journal_add(struct journal_entries *entries, const struct journal_entries *more)
{
	size_t count = (size_t)entries->count + more->count;
	struct journal_entry *all;

	if (!more->count)
		return true;
	all = realloc(entries->entry, count * sizeof(*all));
	if (!all)
		return false;
	memcpy(all + entries->count, more->entry, more->count * sizeof(*all));
	entries->entry = all;
	entries->count = (unsigned)count;
	qsort(all, count, sizeof(*all), journal_order);
	return true;
}

void journal_free(struct journal_entries *entries)
{
	free(entries->entry);
	*entries = (struct journal_entries){0};
}

/* --- Showing --------------------------------------------------------------------------------- */

const char *journal_event(const struct journal_entry *entry, char text[JOURNAL_EVENT])
{
	const struct ows_alarm *alarm = &entry->alarm;

	if (entry->is_command)
		return ows_reason_text(entry->command.reason);
	if (!alarm->kind)
		return ows_alarm_event_text(alarm->event);
	snprintf(text, JOURNAL_EVENT, "%s %s", ows_alarm_kind_text(alarm->kind),
	         ows_alarm_event_text(alarm->event));
	return text;
}

const char *journal_value(const struct journal_entry *entry, int decimals,
                          char text[VALUE_TEXT_MAX])
{
	const struct ows_alarm *alarm = &entry->alarm;
	enum ows_type type = (enum ows_type)alarm->type;
	double number = alarm->has_after ? alarm->after : alarm->before;
	int64_t integer = alarm->has_after ? alarm->after_integer : alarm->before_integer;

	if (entry->is_command) {
		type = (enum ows_type)entry->command.type;
		number = entry->command.number;
		integer = entry->command.integer;
	} else if (!alarm->has_after && !alarm->has_before) {
		return NULL;
	}
	if (type == OWS_STRING)
		return NULL;
	digits_print(type, number, integer, decimals, text);
	return text;
}

bool journal_is_deed(const struct journal_entry *entry)
{
	return entry->is_command ||
	       (entry->alarm.event != OWS_ALARM_RAISED &&
	        entry->alarm.event != OWS_ALARM_RETURNED && entry->alarm.event != OWS_ALARM_FAILED);
}

const struct ows_by *journal_by(const struct journal_entry *entry)
{
	return entry->is_command ? &entry->command.who : &entry->alarm.who;
}

static void put_digits(struct json *json, const char *key, uint8_t type, const char *text,
                       bool browser)
{
	if (browser && type == OWS_LARGE && text)
		json_exact(json, key, strtoll(text, NULL, 10));
	else
		json_number(json, key, text);
}

/* What an alarm had before and after it. */
static void json_number_of(struct json *json, const char *key, const struct ows_alarm *alarm,
                           bool has, double number, int64_t integer, bool browser)
{
	char text[VALUE_TEXT_MAX];

	has &= alarm->type != OWS_STRING;
	if (has)
		digits_print((enum ows_type)alarm->type, number, integer, -1, text);
	put_digits(json, key, alarm->type, has ? text : NULL, browser);
}

static void json_value(struct json *json, const struct journal_entry *entry, bool browser)
{
	char value[VALUE_TEXT_MAX];
	const char *text = journal_value(entry, -1, value);
	uint8_t type = entry->is_command ? entry->command.type : entry->alarm.type;

	if (entry->is_command && entry->command.type == OWS_STRING)
		json_text(json, entry->command.text, strlen(entry->command.text));
	else if (text && type == OWS_BOOL)
		json_bool(json, "value", *text == '1');
	else
		put_digits(json, "value", type, text, browser);
}

void journal_json(struct json *json, const struct when *now, const struct journal_entry *entry,
                  bool browser)
{
	static const struct ows_by none;
	const struct ows_alarm *alarm = &entry->alarm;
	char time[WHEN_TEXT];

	json_object(json, NULL);
	json_string(json, "time", when_iso(now, entry->when_ns, time));
	json_string(json, "journal", entry->is_command ? "commands" : "alarms");
	if (entry->past)
		json_null(json, "number");
	else
		json_uint(json, "number", entry->number);
	json_string(json, "name", entry->name);
	if (entry->is_command) {
		json_null(json, "alarm");
		json_string(json, "event", ows_reason_text(entry->command.reason));
	} else {
		json_string(json, "alarm", alarm->kind ? ows_alarm_kind_text(alarm->kind) : NULL);
		json_string(json, "event", ows_alarm_event_text(alarm->event));
	}
	json_value(json, entry, browser);
	if (!entry->is_command) {
		json_number_of(json, "before", alarm, alarm->has_before, alarm->before,
		               alarm->before_integer, browser);
		json_number_of(json, "after", alarm, alarm->has_after, alarm->after,
		               alarm->after_integer, browser);
		json_string(json, "quality", ows_quality_text(alarm->quality));
	}
	actor_json(json, journal_is_deed(entry) ? journal_by(entry) : &none);
	if (entry->past && entry->is_command)
		json_null(json, "more");
	else
		json_uint(json, "more", entry->is_command ? entry->command.more : 0);
	json_string(json, "remark", !entry->is_command && *alarm->text ? alarm->text : NULL);
	json_object_end(json);
}
