/* SPDX-License-Identifier: MIT */
/* The journals of alarms and of commands, and how the alarms of a signal stand. */
#include <errno.h>
#include <string.h>

#include "src/ground/signal/unarmed.h"
#include "src/ground/signal/value.h"
#include "src/memory/libows/actor.h"
#include "src/memory/libows/alive.h"
#include "src/memory/libows/handle.h"
#include "src/memory/shm/reader.h"

/* Fills the members of a shelved alarm; leaves them as they are if no entry is of the record. */
static void shelved_of(struct ows *h, uint32_t record, struct ows_alarm_state *state)
{
	uint32_t count = map_count(&h->map, OWS_AREA_SHELVES);
	struct ows_shelf_entry e;

	for (uint32_t i = 0; i < count; i++) {
		if (!reader_entry(map_entry(&h->map, OWS_AREA_SHELVES, i), &e, sizeof(e)) ||
		    e.record != record)
			continue;
		state->since_ns = e.since_ns;
		state->until_ns = e.until_ns;
		state->who = actor_of(&e.who);
		memcpy(state->why, e.why, sizeof(state->why) - 1);
		return;
	}
}

/*
 * The entry of that number of a journal; head: the number of the next one. Returns 0; -ENOENT: it
 * is not there, or no longer kept; -EAGAIN: owsd is writing it.
 */
static int journal_read(struct ows *h, enum ows_area area, uint32_t head, uint32_t number,
                        struct ows_journal_entry *e)
{
	uint32_t kept = map_count(&h->map, area);

	if (head - 1 - number >= kept)
		return -ENOENT;
	if (!reader_entry(map_entry(&h->map, area, number % kept), e, sizeof(*e)))
		return -EAGAIN;
	return e->number == number && e->record && e->record < h->map.count ? 0 : -ENOENT;
}

uint32_t ows_alarm_count(struct ows *h)
{
	return __atomic_load_n(&h->map.image->alarm_head, __ATOMIC_ACQUIRE);
}

static void fill_number(uint8_t type, int64_t value, double *number, int64_t *integer)
{
	*number = value_number((enum ows_type)type, value);
	*integer = value_is_float((enum ows_type)type) ? 0 : value;
}

int ows_alarm(struct ows *h, uint32_t number, struct ows_alarm *alarm)
{
	struct ows_journal_entry e;
	int err = journal_read(h, OWS_AREA_ALARMS, ows_alarm_count(h), number, &e);

	if (err)
		return err;
	*alarm = (struct ows_alarm){
		.signal = (int)e.record - 1,
		.occurred_ns = e.occurred_ns,
		.type = map_record(&h->map, e.record)->type,
		.has_before = (e.flags & OWS_JOURNAL_BEFORE) != 0,
		.has_after = (e.flags & OWS_JOURNAL_AFTER) != 0,
		.kind = e.kind,
		.event = e.event,
		.quality = e.quality,
		.who = actor_of(&e.who),
	};
	if (alarm->has_before)
		fill_number(alarm->type, e.before, &alarm->before, &alarm->before_integer);
	if (alarm->has_after)
		fill_number(alarm->type, e.after, &alarm->after, &alarm->after_integer);
	memcpy(alarm->text, e.text, sizeof(alarm->text) - 1);
	return 0;
}

uint32_t ows_command_count(struct ows *h)
{
	return __atomic_load_n(&h->map.image->command_head, __ATOMIC_ACQUIRE);
}

int ows_command_entry(struct ows *h, uint32_t number, struct ows_commanded *commanded)
{
	struct ows_journal_entry e;
	int err = journal_read(h, OWS_AREA_COMMANDS, ows_command_count(h), number, &e);

	if (err)
		return err;
	*commanded = (struct ows_commanded){
		.signal = (int)e.record - 1,
		.taken_ns = e.occurred_ns,
		.more = e.more,
		.type = map_record(&h->map, e.record)->type,
		.reason = e.kind,
		.quality = e.quality,
		.who = actor_of(&e.who),
	};
	if (commanded->type == OWS_STRING) {
		memcpy(commanded->text, e.text, sizeof(commanded->text) - 1);
		return 0;
	}
	fill_number(commanded->type, e.after, &commanded->number, &commanded->integer);
	return 0;
}

const char *ows_reason_text(uint8_t reason)
{
	static const char *const texts[] = {
		[OWS_REASON_NONE] = "none",         [OWS_REASON_SET] = "set",
		[OWS_REASON_RETURNED] = "returned", [OWS_REASON_INIT] = "InitValue",
		[OWS_REASON_SAFE] = "SafeValue",    [OWS_REASON_LAST] = "last",
	};

	return reason < sizeof(texts) / sizeof(texts[0]) ? texts[reason] : "unknown";
}

int ows_alarm_state(struct ows *h, int id, struct ows_alarm_state *state)
{
	uint32_t record = handle_record(h, id);
	const struct ows_record *r = map_record(&h->map, record);
	const struct ows_attrs *a;
	struct ows_slot slot;

	if (!record)
		return -ENOENT;
	if (!reader_slot(r, &slot))
		return -EAGAIN;
	a = &slot.attrs;
	*state = (struct ows_alarm_state){
		.occurrences = a->alarms,
		.item = (r->flags & OWS_RECORD_ALARM) != 0,
		.stands = (a->flags & OWS_ATTR_ALARM_STANDS) != 0,
		.polled = (a->flags & OWS_ATTR_ALARM_POLLED) != 0,
		.limits = (a->flags & OWS_ATTR_LIMITS) != 0,
		.limit_state = a->limit_state,
		.limit_kind = a->limit_condition,
		.unarmed = unarmed_of(a->flags),
		.shelved = a->shelved,
	};
	if (a->shelved)
		shelved_of(h, record, state);
	return handle_state(h);
}

const char *ows_limit_state_text(uint8_t state)
{
	static const char *const texts[] = {
		[OWS_LIMIT_NORMAL] = "normal",
		[OWS_LIMIT_UNACKNOWLEDGED] = "unacknowledged",
		[OWS_LIMIT_ACKNOWLEDGED] = "acknowledged",
		[OWS_LIMIT_RETURNED] = "returned to normal unacknowledged",
	};

	return state < sizeof(texts) / sizeof(texts[0]) ? texts[state] : "unknown";
}

const char *ows_alarm_kind_text(uint8_t kind)
{
	static const char *const texts[] = {
		[OWS_ALARM_DEVICE] = "device",
		[OWS_ALARM_POR] = "power-on reset",
		[OWS_ALARM_HH] = "high high",
		[OWS_ALARM_H] = "high",
		[OWS_ALARM_L] = "low",
		[OWS_ALARM_LL] = "low low",
		[OWS_ALARM_STALE] = "stale",
		[OWS_ALARM_BAD] = "bad",
		[OWS_ALARM_DIFFERS] = "not as commanded",
	};

	return kind < sizeof(texts) / sizeof(texts[0]) && texts[kind] ? texts[kind] : "none";
}

const char *ows_alarm_event_text(uint8_t event)
{
	static const char *const texts[] = {
		[OWS_ALARM_RAISED] = "raised",
		[OWS_ALARM_RETURNED] = "returned",
		[OWS_ALARM_ACKNOWLEDGED] = "acknowledged",
		[OWS_ALARM_SHELVED] = "shelved",
		[OWS_ALARM_UNSHELVED] = "unshelved",
		[OWS_ALARM_FAILED] = "failed",
	};

	return event < sizeof(texts) / sizeof(texts[0]) && texts[event] ? texts[event] : "unknown";
}
