/* SPDX-License-Identifier: MIT */
/* What must be true of signals. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "src/daemon/engine/table.h"
#include "src/ground/signal/value.h"
#include "src/public/ows.h"
#include "tests/endurance/invariants.h"

/* A device that fails is tried again after 60 s at most, and a target has 20 s for an answer. */
#define UNTRIED_NS (180 * FIELD_S)
/* When all is well: a turn of its own, and others before it. */
#define LATE_NS (60 * FIELD_S)
#define SPIN_NS (20 * FIELD_S)
#define SPINS 20000

struct item items[ITEMS];
unsigned item_count;
int commanded;

static struct {
	uint32_t record;
	struct ows_sample sample;
	int64_t idle_ns; /* nobody was there to serve it */
} last[ITEMS];
static int64_t excused_ns, spin_ns;
static uint64_t checked, good, spin_steps;

uint32_t record_of(const char *name)
{
	const struct config *c = station.now_serving->config;

	for (unsigned i = 0; i < c->item_count; i++)
		if (strcmp(c->items[i].name, name) == 0)
			return i + 1;
	return 0;
}

struct ows_sample sample_of(uint32_t record)
{
	const struct ows_record *r = &station.now_serving->image.records[record];

	return r->slot[(r->seq >> 1) & 1].sample;
}

static const char *text_of(uint32_t record, uint32_t len)
{
	static char text[TABLE_TEXT_CAP + 1];
	const struct image *image = &station.now_serving->image;
	const struct ows_record *r = &image->records[record];

	memcpy(text, image->base + r->text_off + ((r->seq >> 1) & 1) * r->text_cap, len);
	text[len] = '\0';
	return text;
}

static const struct part *part_of(const struct ows_sample *sample)
{
	const struct generation *g = station.now_serving;

	return sample->target < g->port_count ? g->bus[sample->target]->part : NULL;
}

static double number(const struct item *item, int64_t value)
{
	return item->kind == ITEM_TEMPERATURE ? value_number(OWS_DOUBLE, value) : (double)value;
}

static _Noreturn void fails(const char *what, const struct item *item, const struct ows_sample *s)
{
	char text[200];

	snprintf(text, sizeof(text),
	         "%s (value %g, quality 0x%02x, error %d, target %u, tried %.3f s ago, "
	         "measured %.3f s ago, update %u)",
	         item->name, number(item, s->value), s->quality, s->err, s->target,
	         (double)(station.now - s->tried_ns) / 1e9,
	         (double)(station.now - s->measured_ns) / 1e9, s->count);
	world_fails(what, text);
}

/* --- A good sample --------------------------------------------------------------------------- */

static void good_value_is_true(const struct item *item, uint32_t record, const struct ows_sample *s)
{
	const struct part *part = part_of(s);
	int64_t from = s->measured_ns - (part ? part->ops->age_ns : 0), to = s->measured_ns;
	bool is_true = true;

	if (part && part->ops->given)
		to = part->ops->given(part, to);
	switch (item->kind) {
	case ITEM_TEMPERATURE:
		is_true = field_was_temperature((unsigned)item->device, number(item, s->value),
		                                from, to);
		break;
	case ITEM_PINS:
		is_true = field_was_pins((unsigned)s->value >> 4, from, to);
		break;
	case ITEM_TEXT:
		is_true = strcmp(text_of(record, s->len), item->text) == 0;
		break;
	case ITEM_RELAYS:
		break;
	}
	if (!is_true)
		fails("a false value is good", item, s);
}

static void good_value_is_no_power_fault(const struct item *item, const struct ows_sample *s)
{
	double degrees = number(item, s->value);

	if (item->kind != ITEM_TEMPERATURE)
		return;
	if (fabs(degrees - 127.9375) < 0.01)
		fails("127.94 is good", item, s);
	if (fabs(degrees - 85) < 0.0005 &&
	    !field_was_temperature((unsigned)item->device, 85, s->measured_ns - 60 * FIELD_S,
	                           s->measured_ns))
		fails("85 of a power fault is good", item, s);
}

static void good_value_has_a_target(const struct item *item, const struct ows_sample *s)
{
	const struct generation *g = station.now_serving;

	if (s->target >= g->port_count || g->image.targets[s->target].state != 1)
		fails("good, and its target is not up", item, s);
}

/* --- Any sample ------------------------------------------------------------------------------ */

static void measurement_is_past(const struct item *item, const struct ows_sample *s)
{
	if (s->measured_ns > station.now || s->tried_ns > station.now)
		fails("younger than its measurement", item, s);
}

static void measurements_go_on(const struct item *item, const struct ows_sample *s,
                               const struct ows_sample *before)
{
	if (s->target == before->target && s->measured_ns < before->measured_ns)
		fails("older than the one before", item, s);
}

static void updates_are_counted(const struct item *item, const struct ows_sample *s,
                                const struct ows_sample *before)
{
	if (s->count < before->count)
		fails("its count of updates stepped back", item, s);
	if (s->count == before->count &&
	    (s->value != before->value || s->measured_ns != before->measured_ns))
		fails("another value without an update", item, s);
}

static bool is_known(uint8_t quality)
{
	static const uint8_t known[] = {
		OWS_Q_NO_PROPERTY,
		OWS_Q_TYPE,
		OWS_Q_ACCESS,
		OWS_Q_NO_DEVICE,
		OWS_Q_DEVICE,
		OWS_Q_SENSOR,
		OWS_Q_TARGET,
		OWS_Q_SHORT,
		/* a switch that restarted, read before owsd knows of it */
		OWS_Q_DIFFERS,
		OWS_Q_INITIAL,
		OWS_Q_LAST_USABLE,
		OWS_Q_GOOD,
	};

	return memchr(known, quality, sizeof(known)) != NULL;
}

static void quality_goes_legal_ways(const struct item *item, uint32_t record,
                                    const struct ows_sample *s, const struct ows_sample *before)
{
	bool was_good = ows_good(before->quality), is_good = ows_good(s->quality);

	if (!is_known(s->quality))
		fails("a quality that nothing here can have", item, s);
	if (s->quality == before->quality)
		return;
	if (s->quality == OWS_Q_INITIAL)
		fails("initial again", item, s);
	/* what was held, or switched off */
	if (item->kind == ITEM_RELAYS || !record_reads(record))
		return;
	if (is_good && !was_good && s->count == before->count)
		fails("good again without a reading", item, s);
	if (s->quality == OWS_Q_LAST_USABLE && !(before->quality & 0xc0))
		fails("bad, and the last usable value", item, s);
}

static void nothing_starves(const struct item *item, uint32_t record, const struct ows_sample *s)
{
	int64_t since = s->tried_ns > excused_ns ? s->tried_ns : excused_ns;
	int64_t *idle_ns = &last[item - items].idle_ns;

	if (item->kind == ITEM_RELAYS)
		return;
	if (!record_reads(record) || !lane_works(record))
		*idle_ns = station.now;
	if (since < *idle_ns)
		since = *idle_ns;
	if (station.now - since > UNTRIED_NS + item->due_ns)
		fails("starves", item, s);
}

static void nothing_spins(void)
{
	if (station.engine_steps - spin_steps > SPINS)
		world_fails("the engine spins", "");
	if (station.now - spin_ns < SPIN_NS)
		return;
	spin_ns = station.now;
	spin_steps = station.engine_steps;
}

static void check(unsigned i, uint32_t record)
{
	const struct item *item = &items[i];
	struct ows_sample s = sample_of(record), *before = &last[i].sample;

	nothing_starves(item, record, &s);
	/* after a reload that did not know it, it is another signal */
	if (last[i].record && memcmp(&s, before, sizeof(s)) != 0) {
		checked++;
		updates_are_counted(item, &s, before);
		measurements_go_on(item, &s, before);
		quality_goes_legal_ways(item, record, &s, before);
	}
	if (memcmp(&s, before, sizeof(s)) != 0 && ows_good(s.quality)) {
		good++;
		good_value_is_true(item, record, &s);
		good_value_is_no_power_fault(item, &s);
	}
	measurement_is_past(item, &s);
	if (ows_good(s.quality))
		good_value_has_a_target(item, &s);
	last[i].sample = s;
	last[i].record = record;
}

void invariants_step(void)
{
	for (unsigned i = 0; i < item_count; i++) {
		uint32_t record = record_of(items[i].name);

		if (record)
			check(i, record);
		else
			last[i].record = 0;
	}
	nothing_spins();
	accounts_step();
}

/* --- All is well ----------------------------------------------------------------------------- */

static void is_good_and_young(const struct item *item, const struct ows_sample *s)
{
	if (!ows_good(s->quality))
		fails(ows_quality_text(s->quality), item, s);
	if (item->kind == ITEM_RELAYS)
		return;
	if (station.now - s->measured_ns > item->due_ns + LATE_NS)
		fails("good and old", item, s);
}

static void outputs_are_as_commanded(const struct item *item, const struct ows_sample *s)
{
	const struct part *part = part_of(s);

	if (commanded < 0 || item->kind == ITEM_TEMPERATURE || item->kind == ITEM_TEXT || !part)
		return;
	if (item->kind == ITEM_PINS) {
		/* a transistor that conducts pulls its pin low */
		if (((unsigned)s->value & 0xf) != (~(unsigned)commanded & 0xf))
			fails("the chip shows other outputs", item, s);
		return;
	}
	if (s->value != commanded)
		fails("not as commanded", item, s);
	if (part->ops->relays &&
	    part->ops->relays(station.part + (part - station.part)) != (unsigned)commanded)
		fails("the chip has other outputs", item, s);
}

void invariants_well(void)
{
	for (unsigned i = 0; i < item_count; i++) {
		uint32_t record = record_of(items[i].name);
		struct ows_sample s;

		if (!record)
			world_fails("it is not configured", items[i].name);
		s = sample_of(record);
		is_good_and_young(&items[i], &s);
		outputs_are_as_commanded(&items[i], &s);
	}
}

void invariants_excuse(void)
{
	excused_ns = spin_ns = station.now;
	spin_steps = station.engine_steps;
}

void invariants_begin(void)
{
	memset(last, 0, sizeof(last));
	checked = good = 0;
	commanded = 0;
	invariants_excuse();
	accounts_begin();
}

uint64_t invariants_checked(void)
{
	return checked;
}

uint64_t invariants_good(void)
{
	return good;
}
