/* SPDX-License-Identifier: MIT */
/* What the families' tables decide of an item. */
#include <stdio.h>
#include <string.h>

#include "hal/chips/facts.h"
#include "hal/chips/property.h"
#include "hal/owfs/path.h"
#include "src/config/check/know.h"
#include "src/config/check/property.h"
#include "src/config/read/alarm.h"
#include "src/config/read/report.h"
#include "src/ground/signal/unit.h"
#include "src/ground/signal/value.h"

/* How often a switch is read back: it costs a busy wire little. */
#define READ_BACK_NS (10 * INT64_C(1000000000))

/* Where a key stands, or the item if the key is absent. */
static struct rio_position position_of(const struct config_item *item, const char *file,
                                       struct config_spot at)
{
	return (struct rio_position){file, at.line ? at.line : item->line, at.column};
}

/*
 * A property that a chip measures in another unit of the same quantity, and that nothing scales:
 * the scale is that from the one to the other, and the unit is spelled as other programs know it.
 */
static void convert_unit(struct config_item *item)
{
	struct scale *scale = &item->scale;
	struct quantity quantity;

	if (!item->unit || item->type == OWS_STRING || item->type == OWS_BOOL ||
	    scale_changes(scale) || !quantity_of(item->path, &quantity) ||
	    !unit_convert(quantity.unit, item->unit, &scale->factor, &scale->offset))
		return;
	scale->linear = item->converted = scale->factor != 1 || scale->offset != 0;
	item->unit = unit_symbol(item->unit);
}

/*
 * Warn of an integer type for a property with decimals: its value would be bad at every fraction.
 * A scaled value is rounded instead.
 */
static void warn_of_decimals(const struct config_item *item, const char *file,
                             struct config_report *report)
{
	struct quantity quantity;

	if (value_is_float(item->type) || item->type == OWS_STRING || scale_changes(&item->scale) ||
	    !quantity_of(item->path, &quantity) || quantity.decimals <= 0)
		return;
	report_warning(report, position_of(item, file, item->type_at),
	               "\"%s\" has decimals, and a %s has none: write Type double or float",
	               item->path, value_type_name(item->type));
}

static bool has_por(const struct config_item *item)
{
	char path[PATH_LEN_MAX + 8];
	struct path_property property;

	if (!item->device)
		return false;
	snprintf(path, sizeof(path), "/%s/por", item->device);
	property = property_look(path);
	return property.type && property.exists && property.readable;
}

/* What of an output reads as it was written is read back, and the file says how often. */
static void know_read_back(struct config_item *item, const char *file, struct config_report *report)
{
	struct path_property property = property_look(item->path);
	bool reads = property.readable && property.exact && (!property.type || property.holds);
	const char *fault = !item->output              ? "this is an input"
	                    : item->type == OWS_STRING ? "this is a text"
	                    : !reads                   ? "it need not read as it was written"
	                                               : NULL;

	if (fault && item->read_back_ns > 0)
		report_warning(report, position_of(item, file, item->read_back_at),
		               "ReadBack does nothing: %s%s%s", fault,
		               reads || !*property.held ? "" : "; write the Path of ",
		               reads ? "" : property.held);
	if (fault)
		item->read_back_ns = 0;
	else if (item->read_back_ns < 0)
		item->read_back_ns = property.holds ? READ_BACK_NS : 0;
	item->has_por = item->read_back_ns && has_por(item);
	if (item->restores && !item->read_back_ns)
		report_warning(report, position_of(item, file, item->restore_at),
		               "Restore does nothing: the item is not read back (ReadBack)");
}

static bool latch_stays(const struct config_item *item)
{
	const char *value = item->reset_latch ? strchr(item->reset_latch, '=') : NULL;
	struct path_property latch;
	char path[ALARM_PATH];

	if (!item->alarm || !alarm_path(item, item->latch_alarm, path))
		return false;
	latch = property_look(path);
	if (!latch.exists || !(latch.alarm & ALARM_STAYS))
		return false;
	return !value || !value[1] || !alarm_path(item, item->reset_latch, path) ||
	       !(property_look(path).alarm & ALARM_CLEARS);
}

void know_item(struct config_item *item, const char *file, struct config_report *report)
{
	item->family = item->device ? model_of(item->path) : NULL;
	item->latch_stays = latch_stays(item);
	item->whole = property_look(item->path).whole;
	know_read_back(item, file, report);
	convert_unit(item);
	warn_of_decimals(item, file, report);
}

void config_know(struct config *config)
{
	struct config_report silent = {0};

	for (unsigned i = 0; i < config->item_count; i++)
		know_item(&config->items[i], config->file, &silent);
}
