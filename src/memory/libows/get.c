/* SPDX-License-Identifier: MIT */
/* Reads values: a whole sample of the image, its age, and its quality, lowered if owsd is dead. */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/ground/signal/value.h"
#include "src/memory/libows/alive.h"
#include "src/memory/libows/get.h"
#include "src/memory/libows/handle.h"
#include "src/memory/libows/map.h"
#include "src/memory/shm/reader.h"

/* --- A sample as the value that the caller gets ----------------------------------------------- */

static inline void value_fill(const struct ows *h, uint32_t record, struct ows_value *value,
                              const struct ows_sample *sample, uint8_t type)
{
	if (type == OWS_DOUBLE || type == OWS_FLOAT) {
		memcpy(&value->number, &sample->value, sizeof(value->number));
		value->integer = 0;
	} else if (type == OWS_STRING) {
		value->number = 0;
		value->integer = 0;
	} else {
		value->number = (double)sample->value;
		value->integer = sample->value;
	}
	value->measured_ns = sample->measured_ns;
	value->tried_ns = sample->tried_ns;
	value->err = sample->err;
	value->count = sample->count;
	value->applied = give_applied(&h->give, record);
	value->len = sample->len;
	value->type = type;
	value->quality = sample->quality;
	value->detail = sample->detail;
	value->target = sample->target;
}

/* --- Attributes ------------------------------------------------------------------------------ */

static int64_t larger(int64_t a, int64_t b)
{
	return a > b ? a : b;
}

/* Periods from base to now; 0 when the two numbers were read across a boundary. */
static int64_t periods(uint32_t now, uint32_t base)
{
	int32_t n = (int32_t)(now - base);

	return n > 0 ? n : 0;
}

/* The present period: owsd's heart may beat after several of them. */
static uint32_t present_period(const struct ows *h, const struct ows_slot *daemon, int64_t now_ns)
{
	int64_t since_ns = now_ns - daemon->sample.measured_ns, period_ns = h->map.image->period_ns;

	if (since_ns <= 0 || period_ns <= 0)
		return daemon->attrs.per_base;
	return daemon->attrs.per_base + (uint32_t)(since_ns / period_ns);
}

static int64_t take_alarm(struct ows_memory *memory, uint32_t alarms)
{
	bool some = memory->alarms_seen != alarms;

	memory->alarms_seen = alarms;
	return some;
}

/* The attribute as an integer; times in nanoseconds. */
static int64_t attribute_value(struct ows *h, struct ows_id *id, const struct ows_slot *slot,
                               uint32_t period, int64_t age_ns)
{
	const struct ows_attrs *a = &slot->attrs;
	int64_t pend = a->flags & OWS_ATTR_IN_WORK ? periods(period, a->pend_base) : 0;

	switch (id->attribute) {
	case ATTR_VALUE:
	case ATTR_DRIVER_RECONNECTS:
		return slot->sample.value;
	case ATTR_TRANSACTIONS:
	case ATTR_DRIVER_TRANSACTIONS:
		return (int64_t)a->transactions;
	case ATTR_READ_ENABLE:
		return (a->flags & OWS_ATTR_READ_ENABLE) != 0;
	case ATTR_WRITE_ENABLE:
		return (a->flags & OWS_ATTR_WRITE_ENABLE) != 0;
	case ATTR_ALARM:
		return take_alarm(&h->memories[id->memory], a->alarms);
	case ATTR_PER_FACTOR:
		return map_info(&h->map, (uint32_t)id->record)->per_factor;
	case ATTR_PER_COUNT:
		return periods(period, a->per_base);
	case ATTR_PER_MAX:
		return larger(a->per_max, periods(period, a->per_base));
	case ATTR_PEND_COUNT:
		return pend;
	case ATTR_PEND_LAST:
		return a->pend_last;
	case ATTR_PEND_MAX:
		return larger(a->pend_max, pend);
	case ATTR_PERIOD:
		return a->update_ns;
	case ATTR_AGE:
		return age_ns;
	case ATTR_AGE_MAX:
		return larger(a->age_max_ns, age_ns);
	case ATTR_RAW: /* ows_get() has it from the sample: it is a measurement */
	case ATTR_DGNRESET:
	case ATTR_READ_ONE_SHOT:
	case ATTR_WRITE_ONE_SHOT:
	case ATTR_DRIVER_DGNRESET:
	case ATTR_COUNT:
		break;
	}
	return 0;
}

/* As ows_get(), for an id that names an attribute. */
static int attribute_get(struct ows *h, struct ows_id *id, int64_t now_ns, struct ows_value *value)
{
	const struct attribute_def *def = &attribute_table[id->attribute];
	struct ows_slot slot, daemon;
	int64_t since, result;
	bool alive = handle_alive(h, now_ns);
	int err = handle_state(h);

	*value = (struct ows_value){.type = (uint8_t)def->type, .quality = OWS_Q_NO_OWSD};
	if (!def->readable) {
		value->quality = OWS_Q_NO_PROPERTY;
		return -EACCES;
	}
	if (!reader_slot(map_record(&h->map, (uint32_t)id->record), &slot) ||
	    !reader_slot(map_record(&h->map, 0), &daemon))
		return -EAGAIN;
	value_fill(h, (uint32_t)id->record, value, &slot.sample, (uint8_t)def->type);
	since = slot.sample.measured_ns != 0 ? slot.sample.measured_ns : h->map.image->start_ns;
	value->age_ns = handle_age(now_ns, since);
	result = attribute_value(h, id, &slot, present_period(h, &daemon, now_ns), value->age_ns);
	value->number = def->type == OWS_DOUBLE ? (double)result / NS_PER_S : (double)result;
	value->integer = def->type == OWS_DOUBLE ? 0 : result;
	value->len = 0;
	value->quality = err || !alive ? OWS_Q_NO_OWSD : OWS_Q_GOOD;
	return err;
}

/* --- Values ---------------------------------------------------------------------------------- */

/* Has owsd ended, or not yet begun? */
static bool stopped(const struct ows *h)
{
	uint32_t state = __atomic_load_n(&h->map.image->state, __ATOMIC_RELAXED);

	return state != OWS_STATE_LIVE && state != OWS_STATE_RETIRED;
}

/* Set the age and lower the quality; returns what ows_get() returns. */
static inline int finish_value(struct ows *h, int64_t stale_after_ns, int64_t now_ns,
                               struct ows_value *value)
{
	int64_t since = value->measured_ns != 0 ? value->measured_ns : h->map.image->start_ns;
	bool alive = handle_alive(h, now_ns);
	int err = handle_state(h);

	value->age_ns = handle_age(now_ns, since);
	if (ows_good(value->quality)) {
		/* a retired image stays good until its last heartbeat is too old */
		if (stopped(h) || !alive || handle_ahead(h, now_ns, since))
			value->quality = OWS_Q_NO_OWSD;
		else if (stale_after_ns > 0 && value->age_ns > stale_after_ns)
			value->quality = OWS_Q_STALE;
	}
	return err;
}

static inline int get_record(struct ows *h, unsigned record, int64_t stale_after_ns, int64_t now_ns,
                             struct ows_value *value)
{
	const struct ows_record *r = map_record(&h->map, record);
	struct ows_sample sample;

	if (!reader_sample(r, &sample)) {
		*value = (struct ows_value){.type = r->type, .quality = OWS_Q_NO_OWSD};
		return -EAGAIN;
	}
	value_fill(h, record, value, &sample, r->type);
	return finish_value(h, stale_after_ns, now_ns, value);
}

/* The raw value is as old and as good as the value that was made of it. */
static int get_raw(struct ows *h, struct ows_id *e, int64_t now_ns, struct ows_value *value)
{
	const struct ows_record *r = map_record(&h->map, (unsigned)e->record);
	struct ows_slot slot;

	if (!reader_slot(r, &slot)) {
		*value = (struct ows_value){.type = OWS_DOUBLE, .quality = OWS_Q_NO_OWSD};
		return -EAGAIN;
	}
	slot.sample.value = slot.attrs.raw;
	if (r->type == OWS_STRING)
		slot.sample.quality = OWS_Q_TYPE;
	value_fill(h, (uint32_t)e->record, value, &slot.sample, OWS_DOUBLE);
	value->len = 0;
	return finish_value(h, e->stale_after_ns, now_ns, value);
}

static int get_id(struct ows *h, struct ows_id *e, int64_t now_ns, struct ows_value *value)
{
	if (e->attribute == ATTR_VALUE)
		return get_record(h, (unsigned)e->record, e->stale_after_ns, now_ns, value);
	return e->attribute == ATTR_RAW ? get_raw(h, e, now_ns, value)
	                                : attribute_get(h, e, now_ns, value);
}

int ows_get(struct ows *h, int id, int64_t now_ns, struct ows_value *value)
{
	if ((unsigned)id >= h->id_count || h->ids[id].record < 0) {
		*value = (struct ows_value){.quality = OWS_Q_NO_PROPERTY};
		return -ENOENT;
	}
	return get_id(h, &h->ids[id], now_ns, value);
}

int ows_get_signal(struct ows *h, int signal, int64_t now_ns, struct ows_value *value)
{
	if (signal < 0 || signal >= ows_count(h)) {
		*value = (struct ows_value){.quality = OWS_Q_NO_PROPERTY};
		return -ENOENT;
	}
	return get_record(h, (unsigned)signal + 1,
	                  map_info(&h->map, (unsigned)signal + 1)->stale_after_ns, now_ns, value);
}

static int print_number(const struct ows_value *value, char *text, size_t size)
{
	char room[VALUE_TEXT_MAX];
	int64_t bits = value_is_float((enum ows_type)value->type) ? value_of_double(value->number)
	                                                          : value->integer;
	size_t n = (size_t)value_to_text((enum ows_type)value->type, bits, room);
	int err = 0;

	if (n >= size) {
		n = size - 1;
		err = -ENOSPC;
	}
	memcpy(text, room, n);
	text[n] = '\0';
	return err;
}

static int get_string(struct ows *h, const struct ows_id *e, int64_t now_ns,
                      struct ows_value *value, char *text, size_t size)
{
	const struct ows_record *r = map_record(&h->map, (uint32_t)e->record);
	struct ows_sample sample;
	int err;

	if (!map_has_text(&h->map, r) || !reader_text(h->map.base, r, &sample, text, size)) {
		text[0] = '\0';
		*value = (struct ows_value){.type = r->type, .quality = OWS_Q_NO_OWSD};
		return -EAGAIN;
	}
	value_fill(h, (uint32_t)e->record, value, &sample, r->type);
	err = finish_value(h, e->stale_after_ns, now_ns, value);
	return !err && sample.len >= size ? -ENOSPC : err;
}

int handle_get_text(struct ows *h, struct ows_id *e, int64_t now_ns, struct ows_value *value,
                    char *text, size_t size)
{
	int err, cut;

	if (e->attribute == ATTR_VALUE &&
	    map_record(&h->map, (uint32_t)e->record)->type == OWS_STRING)
		return get_string(h, e, now_ns, value, text, size);
	err = get_id(h, e, now_ns, value);
	if (err && err != -ESTALE)
		return err;
	cut = print_number(value, text, size);
	return err ? err : cut;
}

int ows_get_text(struct ows *h, int id, int64_t now_ns, struct ows_value *value, char *text,
                 size_t size)
{
	if (size == 0)
		return -ENOSPC;
	text[0] = '\0';
	if ((unsigned)id >= h->id_count || h->ids[id].record < 0)
		return ows_get(h, id, now_ns, value);
	return handle_get_text(h, &h->ids[id], now_ns, value, text, size);
}

int ows_get_signal_text(struct ows *h, int signal, int64_t now_ns, struct ows_value *value,
                        char *text, size_t size)
{
	struct ows_id id = {.record = signal + 1, .attribute = ATTR_VALUE};

	if (size == 0)
		return -ENOSPC;
	text[0] = '\0';
	if (signal < 0 || signal >= ows_count(h))
		return ows_get_signal(h, signal, now_ns, value);
	id.stale_after_ns = map_info(&h->map, (unsigned)signal + 1)->stale_after_ns;
	return handle_get_text(h, &id, now_ns, value, text, size);
}

int ows_command(struct ows *h, int id, struct ows_command *command)
{
	uint32_t record = handle_record(h, id);
	const struct ows_record *r = map_record(&h->map, record);
	const struct ows_command_slot *own;
	struct ows_slot slot;

	*command = (struct ows_command){0};
	if (!record)
		return -ENOENT;
	if (!reader_slot(r, &slot))
		return -EAGAIN;
	command->given = (slot.attrs.flags & OWS_ATTR_COMMANDED) != 0 && r->type != OWS_STRING;
	command->pending = (slot.sample.flags & OWS_SAMPLE_PENDING) != 0;
	command->safe = (slot.sample.flags & OWS_SAMPLE_SAFE) != 0;
	if (command->given) {
		command->number = value_number((enum ows_type)r->type, slot.attrs.commanded);
		if (!value_is_float((enum ows_type)r->type))
			command->integer = slot.attrs.commanded;
	}
	if (h->give.base != NULL) {
		own = give_slot(&h->give, record);
		command->applied = give_applied(&h->give, record);
		/* owsd stores err before taken */
		command->taken = __atomic_load_n(&own->taken, __ATOMIC_ACQUIRE);
		command->refused = (int32_t)word_get((const uint32_t *)&own->err);
	}
	return handle_state(h);
}
