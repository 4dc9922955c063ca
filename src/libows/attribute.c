/* SPDX-License-Identifier: MIT */
/* Computes the attributes of a signal from what owsd publishes and from the running time. */
#include <errno.h>

#include "hal/bus/time.h"
#include "src/libows/alive.h"
#include "src/libows/attribute.h"
#include "src/libows/handle.h"
#include "src/libows/sample.h"
#include "src/shm/reader.h"

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
static int64_t compute(struct ows *h, struct ows_id *id, const struct ows_slot *slot,
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
	case ATTR_WRITE_ONE_SHOT:
	case ATTR_DRIVER_DGNRESET:
	case ATTR_COUNT:
		break;
	}
	return 0;
}

int attribute_get(struct ows *h, struct ows_id *id, int64_t now_ns, struct ows_value *value)
{
	const struct attribute_def *def = &attribute_table[id->attribute];
	struct ows_slot slot, daemon;
	int64_t since, result;
	bool alive = handle_alive(h, now_ns);
	int err = handle_state(h);

	*value = (struct ows_value){.type = (uint8_t)def->type, .quality = OWS_Q_TARGET};
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
	result = compute(h, id, &slot, present_period(h, &daemon, now_ns), value->age_ns);
	value->number = def->type == OWS_DOUBLE ? (double)result / NS_PER_S : (double)result;
	value->integer = def->type == OWS_DOUBLE ? 0 : result;
	value->len = 0;
	value->quality = err || !alive ? OWS_Q_TARGET : OWS_Q_GOOD;
	return err;
}
