/* SPDX-License-Identifier: MIT */
/* What an item's value means: unit and description, scale, filter and range. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/config/read/build.h"
#include "src/config/read/options.h"
#include "src/config/read/scaling.h"
#include "src/ground/signal/value.h"

/* --- Scale, Offset, Points ------------------------------------------------------------------- */

static void report_points(struct build *build, const struct option_value *points, int err)
{
	static const char form[] = "expected points RAW:VALUE with blanks between, such as "
				   "\"4:0 20:100\"";
	char many[64];
	const char *expected = form;

	snprintf(many, sizeof(many), "expected at most %d points", SCALE_POINTS_MAX);
	if (err == -E2BIG)
		expected = many;
	else if (err == -EDOM)
		expected = "expected two points at least, such as \"4:0 20:100\"";
	else if (err == -EINVAL)
		expected = "expected raw values that rise from point to point";
	else if (err == -ERANGE)
		expected = "expected values that all rise or all fall: else a value has no "
			   "single raw value";
	report_error(build->report, points->node->value_at, "Points \"%s\": %s", points->text,
	             expected);
}

static void build_points(struct build *build, const struct option_value *values,
                         struct config_item *item)
{
	const struct option_value *points = &values[OPT_POINTS];
	const struct option_value *beside = values[OPT_SCALE].given ? &values[OPT_SCALE]
	                                                            : &values[OPT_OFFSET];
	struct scale_point found[SCALE_POINTS_MAX], *kept;
	int count;

	if (!points->given)
		return;
	if (beside->given)
		report_error(build->report, points->node->at,
		             "Points contradicts %s in line %d: expected one of the two",
		             beside->node->key, beside->node->at.line);
	count = scale_parse(points->text, found);
	if (count < 0) {
		report_points(build, points, count);
		return;
	}
	kept = build_take(build, (size_t)count, sizeof(*kept));
	if (!kept)
		return;
	memcpy(kept, found, (size_t)count * sizeof(*kept));
	item->scale.points = kept;
	item->scale.count = (unsigned)count;
}

static void build_scale(struct build *build, const struct option_value *values,
                        struct config_item *item)
{
	const struct option_value *factor = &values[OPT_SCALE], *offset = &values[OPT_OFFSET];
	struct scale *scale = &item->scale;

	scale->factor = item->factor;
	scale->offset = item->offset;
	scale->linear = scale->factor != 1 || scale->offset != 0;
	if (factor->given && factor->number == 0)
		report_error(build->report, factor->node->value_at,
		             "Scale \"%s\": expected a number other than 0", factor->text);
	build_points(build, values, item);
	if (item->type == OWS_BOOL && scale->linear && (scale->factor != -1 || scale->offset != 1))
		report_error(build->report, factor->given ? factor->node->at : offset->node->at,
		             "a bool can only be inverted: expected Scale -1 and Offset 1");
}

/* --- Range ----------------------------------------------------------------------------------- */

static void check_range(struct build *build, const struct option_value *values)
{
	const struct option_value *min = &values[OPT_MIN], *max = &values[OPT_MAX];

	if (min->given && max->given && max->number <= min->number)
		report_error(build->report, max->node->value_at,
		             "Max \"%s\": expected more than Min, which is %s in line %d",
		             max->text, min->text, min->node->at.line);
}

/* InitValue and SafeValue are engineering values, and owsd writes them as it writes commands. */
static void check_value(struct build *build, const struct option_value *value, bool has,
                        int64_t number, const struct config_item *item)
{
	double raw;

	if (has && scale_raw(&item->scale, value_number(item->type, number), &raw))
		report_error(build->report, value->node->value_at,
		             "%s \"%s\": expected a value from Min to Max, and of the Points",
		             value->node->key, value->text);
}

/* --- All ------------------------------------------------------------------------------------- */

/* A text has no number to work on; a bool has only 0 and 1. */
static void refuse_for_type(struct build *build, const struct option_value *values,
                            const struct config_item *item)
{
	static const enum option of_numbers[] = {OPT_DECIMALS, OPT_SCALE,  OPT_OFFSET,
	                                         OPT_POINTS,   OPT_MIN,    OPT_MAX,
	                                         OPT_MAX_STEP, OPT_FILTER, OPT_DEADBAND};

	if (item->type != OWS_STRING && item->type != OWS_BOOL)
		return;
	for (size_t i = 0; i < sizeof(of_numbers) / sizeof(of_numbers[0]); i++) {
		const struct option_value *value = &values[of_numbers[i]];

		if (item->type == OWS_BOOL &&
		    (of_numbers[i] == OPT_SCALE || of_numbers[i] == OPT_OFFSET))
			continue;
		if (value->given)
			report_error(build->report, value->node->at,
			             "%s: a %s has none; remove it, or write a Type of numbers",
			             value->node->key, value_type_name(item->type));
	}
}

/* What works on readings alone. */
static double of_input(struct build *build, const struct option_value *value,
                       const struct config_item *item)
{
	if (item->output && value->given && build_sound(build))
		report_warning(build->report, value->node->at,
		               "%s does nothing: this Item is an output", value->node->key);
	return item->output ? 0 : value->number;
}

void scaling_build(struct build *build, const struct option_value *values, bool known,
                   struct config_item *item)
{
	bool number = known && item->type != OWS_STRING;

	if (known)
		refuse_for_type(build, values, item);
	build_scale(build, values, item);
	check_range(build, values);
	item->max_step = of_input(build, &values[OPT_MAX_STEP], item);
	item->filter_s = of_input(build, &values[OPT_FILTER], item);
	check_value(build, &values[OPT_INIT_VALUE], number && item->has_init, item->init_value,
	            item);
	check_value(build, &values[OPT_SAFE_VALUE], number && item->has_safe, item->safe_value,
	            item);
}
