/* SPDX-License-Identifier: MIT */
/* Finds the blocks that edits change, and makes those that are not there. */
#include <stdio.h>
#include <string.h>

#include "src/config/check/targets.h"
#include "src/config/edit/edit_block.h"
#include "src/config/edit/rio_write.h"
#include "src/ground/text/distance.h"

struct rio_node *edit_driver(const struct rio *rio)
{
	struct rio_node *node = rio_child(&rio->root, EDIT_DRIVER);

	return node && node->kind == RIO_BLOCK ? node : NULL;
}

struct rio_node *edit_items(const struct rio *rio)
{
	struct rio_node *driver = edit_driver(rio);

	return driver ? rio_child(driver, option_table[OPT_ITEM].key) : NULL;
}

struct rio_node *edit_item(const struct rio *rio, const char *name)
{
	struct rio_node *item = edit_items(rio);

	for (; item; item = rio_next(item)) {
		const struct rio_node *found = rio_child(item, option_table[OPT_NAME].key);

		if (item->kind == RIO_BLOCK && found && !strcmp(found->value, name))
			return item;
	}
	return NULL;
}

/* The target in "Bus:TARGET"; NULL: it is no such name. */
static const char *bus_target(const char *name)
{
	return strncmp(name, EDIT_BUS, strlen(EDIT_BUS)) == 0 ? name + strlen(EDIT_BUS) : NULL;
}

static struct rio_node *find_bus(const struct rio_node *driver, const char *target)
{
	struct rio_node *bus = rio_child(driver, option_table[OPT_BUS].key);

	for (; bus; bus = rio_next(bus)) {
		const struct rio_node *found = rio_child(bus, option_table[OPT_BUS_TARGET].key);

		if (bus->kind == RIO_BLOCK && found && target_same(found->value, target))
			return bus;
	}
	return NULL;
}

void edit_no_item(const struct rio *rio, const char *name, struct config_report *report)
{
	const struct rio_node *item = edit_items(rio);
	unsigned best = text_too_far(name);
	const char *nearest = NULL;

	for (; item; item = rio_next(item)) {
		const struct rio_node *own = rio_child(item, option_table[OPT_NAME].key);

		if (own && text_nearer(name, own->value, &best))
			nearest = own->value;
	}
	report_error(report, (struct rio_position){0}, "there is no item \"%s\"%s%s%s", name,
	             nearest ? "; did you mean \"" : "", nearest ? nearest : "",
	             nearest ? "\"?" : "");
}

struct rio_node *edit_block(const struct rio *rio, const char *name, enum option_place *place,
                            struct config_report *report)
{
	struct rio_node *driver = edit_driver(rio), *block = edit_item(rio, name);
	const char *target = bus_target(name);

	*place = PLACE_ITEM;
	if (block)
		return block;
	if (!strcmp(name, EDIT_DRIVER)) {
		*place = PLACE_DRIVER;
		block = driver;
	} else if (driver && target) {
		*place = PLACE_BUS;
		block = find_bus(driver, target);
	} else if (driver && option_single(name)) {
		*place = option_single(name)->inside;
		block = rio_child(driver, name);
		if (block && block->kind != RIO_BLOCK)
			block = NULL;
	}
	if (!block && target)
		report_error(report, (struct rio_position){0}, "there is no Bus for \"%s\"",
		             target);
	else if (!block)
		edit_no_item(rio, name, report);
	return block;
}

int edit_make_block(struct rio **rio, const char *name)
{
	struct rio_node *driver = edit_driver(*rio);
	const char *target = bus_target(name);
	char text[RIO_KEY_MAX + 8];
	int err;

	if (!driver || edit_item(*rio, name) ||
	    (target ? !*target || find_bus(driver, target)
	            : !option_single(name) || rio_child(driver, name)))
		return 0;
	snprintf(text, sizeof(text), "%s {\n}", target ? option_table[OPT_BUS].key : name);
	err = rio_add(rio, driver, text);
	if (err || !target)
		return err;
	return rio_set_text(rio, edit_driver(*rio)->last, option_table[OPT_BUS_TARGET].key, target);
}
