/* SPDX-License-Identifier: MIT */
/* Makes an item of a block of the file, and reports what is wrong or odd about its keys. */
#include <errno.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "src/config/read/alarm.h"
#include "src/config/read/build.h"
#include "src/config/read/identity.h"
#include "src/config/read/item.h"
#include "src/config/read/options.h"
#include "src/config/read/recorder.h"
#include "src/config/read/scaling.h"
#include "src/ground/signal/attribute.h"
#include "src/ground/signal/value.h"

/* Where a key's value stands, or the item if the key is absent. */
static struct rio_position position_of(const struct option_value *value,
                                       const struct rio_node *block)
{
	return value->node ? value->node->value_at : block->at;
}

/*
 * Report that the key is missing, and which unknown one was probably meant: a warning does not come
 * to everybody who reads the error.
 */
static void report_missing(struct build *build, const struct rio_node *block, const char *key,
                           const char *what)
{
	char text[OPTION_NEAREST];

	if (block->broken)
		return;
	for (const struct rio_node *child = block->first; child; child = child->next) {
		const char *nearest = option_find(PLACE_ITEM, child->key) < 0
		                              ? option_nearest(PLACE_ITEM, child->key, text)
		                              : NULL;

		if (!nearest || !strstr(nearest, key))
			continue;
		report_error(build->report, child->at,
		             "expected %s in this Item: is %s meant to be %s?", what, child->key,
		             nearest);
		return;
	}
	report_error(build->report, block->at, "expected %s in this Item", what);
}

static void build_name(struct build *build, const struct rio_node *block,
                       const struct option_value *values, struct config_item *item)
{
	const struct option_value *name = &values[OPT_NAME];
	const char *fault;

	if (!item->name)
		item->name = "";
	if (!name->node) {
		report_missing(build, block, "Name", "a Name");
		return;
	}
	fault = name->given ? signal_name_fault(name->text) : NULL;
	if (fault)
		report_error(build->report, name->node->value_at, "the name \"%s\" %s", name->text,
		             fault);
}

static void build_path(struct build *build, const struct rio_node *block,
                       const struct option_value *values, struct config_item *item,
                       struct path *path)
{
	const struct option_value *value = &values[OPT_PATH];
	const char *text = value->text, *fault;
	struct rio_position position = position_of(value, block);
	char whole[IDENTITY_MAX];

	memset(path, 0, sizeof(*path));
	item->path = "";
	if (!value->given) {
		if (!value->node)
			report_missing(build, block, "Path", "a Path");
		return;
	}
	fault = path_split(text, strlen(text), path);
	if (!fault && !path->property.len)
		fault = path->device.len ? "has no property after the device" : "has no property";
	if (fault) {
		report_error(build->report, position, "the path \"%s\" %s", text, fault);
		return;
	}
	if (path->alarm)
		report_warning(build->report, position,
		               "the path \"%s\" is entered without /alarm, which is dropped; "
		               "alarms are chosen by Alarm on",
		               text);
	identity_of_path(path, whole);
	item->path = build_keep(build, whole, strlen(whole));
	item->fresh = path->uncached;
	if (!path->has_rom)
		return;
	item->device = build_keep(build, path->last.text, path->last.len);
}

/* The meaning of IOType, before the readable keys; false: its type is no type. */
static bool take_io_type(struct build *build, const struct option_value *value,
                         struct config_item *item)
{
	uint32_t bits = (uint32_t)value->number, unknown = bits & ~IO_TYPE_KNOWN;
	int code = (int)(bits & IO_TYPE_CODE);

	if (unknown)
		report_warning(build->report, value->node->value_at,
		               "IOType %s has the unknown bits 0x%04X, which are ignored",
		               value->text, (unsigned)unknown);
	item->output = bits & IO_TYPE_OUTPUT;
	item->readable = !item->output || (bits & IO_TYPE_INPUT);
	item->writable = item->output;
	item->fresh |= (bits & IO_TYPE_UNCACHED) != 0;
	if (!value_type_ok(code)) {
		report_error(
			build->report, value->node->value_at,
			"IOType %s: %d is not a type; expected 1 bool, 2 byte, 3 short, 4 long, "
			"5 word, 6 dword, 7 float, 8 double, 10 large or 12 string in the "
			"last hexadecimal digit",
			value->text, code);
		return false;
	}
	item->type = (enum ows_type)code;
	return true;
}

/* Returns whether the type is known, so that values can be judged by it. */
static bool build_type(struct build *build, const struct rio_node *block,
                       const struct option_value *values, struct config_item *item)
{
	const struct option_value *bits = &values[OPT_IO_TYPE], *type = &values[OPT_TYPE],
				  *io = &values[OPT_IO];
	bool known = false;

	if (bits->given) {
		known = take_io_type(build, bits, item);
	} else {
		item->output = io->number != 0;
		item->readable = !item->output;
		item->writable = item->output;
	}
	if (type->given) {
		if (known && bits->node && item->type != (enum ows_type)(int)type->number)
			report_error(build->report, type->node->value_at,
			             "Type %s contradicts IOType %s in line %d, which says %s",
			             type->text, bits->text, bits->node->at.line,
			             value_type_name(item->type));
		item->type = (enum ows_type)(int)type->number;
		known = true;
	} else if (!bits->node && !type->node) {
		report_missing(build, block, "Type", "a Type or an IOType");
	}
	if (bits->node && bits->given && io->given && item->output != (io->number != 0))
		report_error(build->report, io->node->value_at,
		             "IO %s contradicts IOType %s in line %d, which says %s", io->text,
		             bits->text, bits->node->at.line, item->output ? "output" : "input");
	return known;
}

static void build_flags(struct build *build, const struct option_value *values,
                        const struct path *path, struct config_item *item)
{
	const struct option_value *uncached = &values[OPT_UNCACHED];

	if (values[OPT_READABLE].given)
		item->readable = values[OPT_READABLE].number != 0;
	if (values[OPT_WRITABLE].given)
		item->writable = values[OPT_WRITABLE].number != 0;
	if (uncached->given && !uncached->number && path->uncached)
		report_error(build->report, uncached->node->value_at,
		             "Uncached %s contradicts Path, which begins with /uncached",
		             uncached->text);
	if (uncached->given)
		item->fresh = uncached->number != 0;
}

/* InitValue or SafeValue of a number type; returns whether there is one. */
static bool build_value(struct build *build, const struct option_value *value,
                        const struct config_item *item, int64_t *number)
{
	int err;

	err = value_parse(item->type, value->text, number);
	if (!err)
		return true;
	if (err == -ERANGE)
		report_error(build->report, value->node->value_at,
		             "%s \"%s\": the type %s cannot hold it", value->node->key, value->text,
		             value_type_name(item->type));
	else
		report_error(build->report, value->node->value_at,
		             "%s \"%s\": expected %s (type %s)", value->node->key, value->text,
		             item->type == OWS_BOOL       ? "0, 1, on, off, yes, no, true or false"
		             : value_is_float(item->type) ? "a number with a decimal point"
		                                          : "a whole number",
		             value_type_name(item->type));
	return false;
}

static void check_string(struct build *build, const struct option_value *value)
{
	if (strlen(value->text) > VALUE_STRING_MAX)
		report_error(build->report, value->node->value_at,
		             "%s: a string is at most %d bytes long", value->node->key,
		             VALUE_STRING_MAX);
}

/* What an output begins with, and how long it waits for the program that it obeyed. */
static void build_start(struct build *build, const struct option_value *values,
                        struct config_item *item)
{
	const struct option_value *delay = &values[OPT_SAFE_DELAY];

	item->starts_last = strcmp(item->start, "last") == 0;
	if (item->starts_last && !item->output)
		report_error(build->report, values[OPT_START].node->value_at,
		             "Start \"last\": expected an output, and this is an input");
	if (delay->given && !item->has_safe && build_sound(build))
		report_warning(build->report, delay->node->at,
		               "SafeDelay does nothing without SafeValue");
	if (item->confirm && !config_item_takes_sets(item) && build_sound(build))
		report_warning(build->report, values[OPT_CONFIRM].node->at,
		               "Confirm does nothing: nobody sets this input");
}

static void build_values(struct build *build, const struct option_value *values, bool known,
                         struct config_item *item)
{
	const struct option_value *init = &values[OPT_INIT_VALUE], *safe = &values[OPT_SAFE_VALUE];

	if (item->type == OWS_STRING) {
		check_string(build, init);
		check_string(build, safe);
		item->has_init = *init->text != '\0';
	} else if (known) {
		item->has_init = *init->text && build_value(build, init, item, &item->init_value);
		item->has_safe = safe->given && build_value(build, safe, item, &item->safe_value);
	}
	build_start(build, values, item);
	if (item->has_safe && !item->output && !item->writable && build_sound(build))
		report_warning(build->report, safe->node->at,
		               "SafeValue does nothing: this input is not Writable");
	if (!values[OPT_READ_BACK].given)
		item->read_back_ns = -1;
}

/* --- Limit alarms: which limits it has, and whether they fit together ------------------------- */

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

static void limits_build(struct build *build, const struct option_value *values,
                         struct config_item *item)
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
	if (limits->any || !build_sound(build))
		return;
	for (unsigned i = 0; i < sizeof(beside) / sizeof(beside[0]); i++)
		if (values[beside[i]].given)
			report_warning(build->report, values[beside[i]].node->at,
			               "%s does nothing: this Item has no limit",
			               values[beside[i]].node->key);
}

/* --------------------------------------------------------------------------------------------- */

void item_build(struct build *build, const struct rio_node *block, struct config_item *item)
{
	struct option_value values[OPTION_COUNT_ALL];
	struct path path;
	bool known;

	build->item_errors = build->report->errors;
	options_read(build, block, PLACE_ITEM, values, item);
	item->line = block->at.line;
	build_name(build, block, values, item);
	build_path(build, block, values, item, &path);
	known = build_type(build, block, values, item);
	build_flags(build, values, &path, item);
	build_values(build, values, known, item);
	scaling_build(build, values, known, item);
	alarm_build(build, block, values, &path, item);
	limits_build(build, values, item);
	record_build(build, &values[OPT_RECORD], known, item);
}
