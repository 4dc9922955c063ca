/* SPDX-License-Identifier: MIT */
/* Limit alarms of an item: which limits it has, and whether they fit together. */
#include "src/config/read/limits.h"
#include "src/config/read/build.h"
#include "src/config/read/options.h"

static const enum option limit_options[CONFIG_LIMITS] = {
	[CONFIG_LIMIT_LL] = OPT_LIMIT_LL,
	[CONFIG_LIMIT_L] = OPT_LIMIT_L,
	[CONFIG_LIMIT_H] = OPT_LIMIT_H,
	[CONFIG_LIMIT_HH] = OPT_LIMIT_HH,
};
static const enum option beside[] = {OPT_HYSTERESIS, OPT_ON_DELAY, OPT_OFF_DELAY};

/* Each limit has to lie above the one before it that is given. */
static void check_order(struct build *build, const struct option_value *values)
{
	const struct option_value *below = NULL;

	for (int i = 0; i < CONFIG_LIMITS; i++) {
		const struct option_value *limit = &values[limit_options[i]];

		if (!limit->given)
			continue;
		if (below && limit->number <= below->number)
			report_error(build->report, limit->node->value_at,
			             "%s \"%s\": expected more than %s, which is %s in line %d",
			             limit->node->key, limit->text, below->node->key, below->text,
			             below->node->at.line);
		below = limit;
	}
}

/* From an upper limit the hysteresis reaches down, from a lower one up: they must not cross. */
static void check_hysteresis(struct build *build, const struct option_value *values)
{
	const struct option_value *hysteresis = &values[OPT_HYSTERESIS];
	const struct option_value *low = values[OPT_LIMIT_L].given ? &values[OPT_LIMIT_L]
	                                                           : &values[OPT_LIMIT_LL];
	const struct option_value *high = values[OPT_LIMIT_H].given ? &values[OPT_LIMIT_H]
	                                                            : &values[OPT_LIMIT_HH];

	if (hysteresis->given && low->given && high->given && low->number < high->number &&
	    hysteresis->number >= high->number - low->number)
		report_error(build->report, hysteresis->node->value_at,
		             "Hysteresis \"%s\": expected less than the %g between %s and %s",
		             hysteresis->text, high->number - low->number, low->node->key,
		             high->node->key);
}

void limits_build(struct build *build, const struct option_value *values, struct config_item *item)
{
	struct config_limits *limits = &item->limits;

	for (int i = 0; i < CONFIG_LIMITS; i++) {
		const struct option_value *limit = &values[limit_options[i]];

		if (!limit->given)
			continue;
		if (item->type == OWS_STRING)
			report_error(build->report, limit->node->at, "%s: a string has no limits",
			             limit->node->key);
		limits->any = true;
	}
	check_order(build, values);
	check_hysteresis(build, values);
	if (limits->any)
		return;
	for (unsigned i = 0; i < sizeof(beside) / sizeof(beside[0]); i++)
		if (values[beside[i]].given)
			report_warning(build->report, values[beside[i]].node->at,
			               "%s does nothing: this Item has no limit",
			               values[beside[i]].node->key);
}
