/* SPDX-License-Identifier: MIT */
/* The rule of Record: change, deadband, interval. */
#include <math.h>

#include "src/ground/signal/value.h"
#include "src/history/recorder/rule.h"

/* NaN is a value like others here: the same as NaN, and far from each number. */
static double distance(const struct ows_value *a, const struct ows_value *b)
{
	/* an integer beyond 2^53 is rounded: two that differ are then at least 1 apart */
	if (!value_is_float((enum ows_type)a->type))
		return a->integer == b->integer
		               ? 0
		               : fmax(fabs((double)a->integer - (double)b->integer), 1);
	if (isnan(a->number) || isnan(b->number))
		return isnan(a->number) && isnan(b->number) ? 0 : HUGE_VAL;
	/* a difference of infinities is none */
	return a->number == b->number ? 0 : fabs(a->number - b->number);
}

bool rule_change(const struct config_record *rule, const struct rule_kept *kept,
                 const struct ows_value *sample)
{
	double moved;

	if (rule->off)
		return false;
	if (!kept->any || kept->sample.type != sample->type ||
	    kept->sample.quality != sample->quality)
		return true;
	moved = distance(&kept->sample, sample);
	if (rule->change && moved > 0)
		return true;
	return rule->deadband > 0 && moved > rule->deadband;
}

static int64_t interval_slot(const struct config_record *rule, int64_t wall_ns)
{
	int64_t slot = wall_ns / rule->interval_ns;

	return wall_ns % rule->interval_ns < 0 ? slot - 1 : slot;
}

bool rule_tick(const struct config_record *rule, struct rule_kept *kept, int64_t wall_ns)
{
	int64_t slot;

	if (rule->interval_ns <= 0)
		return false;
	slot = interval_slot(rule, wall_ns);
	if (slot == kept->slot)
		return false;
	kept->slot = slot;
	return true;
}

bool rule_interval(const struct rule_kept *kept, const struct ows_value *sample)
{
	return !kept->any || sample->measured_ns > kept->sample.measured_ns;
}

int64_t rule_next_tick(const struct config_record *rule, int64_t wall_ns)
{
	if (rule->interval_ns <= 0)
		return INT64_MAX;
	return (interval_slot(rule, wall_ns) + 1) * rule->interval_ns;
}

bool rule_missed(const struct config_record *rule, const struct rule_kept *kept, uint32_t measured,
                 bool ticked, int64_t unseen_ns, int64_t now_ns)
{
	if (!unseen_ns || !kept->any)
		return false;
	if (ticked)
		return now_ns - unseen_ns > rule->interval_ns;
	return (rule->change || rule->deadband > 0) && measured > 1;
}
