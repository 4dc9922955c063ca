/* SPDX-License-Identifier: MIT */
/* Reads values: a whole sample of the image, its age, and its quality, lowered if owsd is dead. */
#include <errno.h>
#include <string.h>

#include "hal/bus/time.h"
#include "src/libows/alive.h"
#include "src/libows/attribute.h"
#include "src/libows/get.h"
#include "src/libows/handle.h"
#include "src/libows/map.h"
#include "src/libows/sample.h"
#include "src/shm/reader.h"
#include "src/signal/value.h"

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
			value->quality = OWS_Q_TARGET;
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
		*value = (struct ows_value){.type = r->type, .quality = OWS_Q_TARGET};
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
		*value = (struct ows_value){.type = OWS_DOUBLE, .quality = OWS_Q_TARGET};
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

int ows_snapshot(struct ows *h, int64_t now_ns, struct ows_value *values, int n)
{
	int count = ows_count(h);

	if (n > count)
		n = count;
	for (int i = 0; i < n; i++)
		ows_get_signal(h, i, now_ns, &values[i]);
	return n > 0 ? n : 0;
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
		*value = (struct ows_value){.type = r->type, .quality = OWS_Q_TARGET};
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
	const struct ows_command_slot *own;
	const struct ows_record *r;
	struct ows_slot slot;
	uint32_t record;

	*command = (struct ows_command){0};
	if ((unsigned)id >= h->id_count || h->ids[id].record <= 0)
		return -ENOENT;
	record = (uint32_t)h->ids[id].record;
	r = map_record(&h->map, record);
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
		command->applied = word_get(&own->applied);
		/* owsd stores err before taken */
		command->taken = __atomic_load_n(&own->taken, __ATOMIC_ACQUIRE);
		command->refused = (int32_t)word_get((const uint32_t *)&own->err);
	}
	return handle_state(h);
}
