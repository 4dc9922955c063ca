/* SPDX-License-Identifier: MIT */
/* Entries of the journals as events of history. */
#include <stdio.h>
#include <string.h>

#include "src/history/recorder/entries.h"
#include "src/history/recorder/series.h"

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
