/* SPDX-License-Identifier: MIT */
/* What an item is known by, its name and its identity: each item has others. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "src/config/read/identity.h"

void identity_of_path(const struct path *path, char out[IDENTITY_MAX])
{
	const char *rest = path->device.len ? path->device.text : path->property.text;
	char bus[16] = "";

	if (path->bus >= 0)
		snprintf(bus, sizeof(bus), "/bus.%d", path->bus);
	snprintf(out, IDENTITY_MAX, "%s/%s", bus, rest);
}

void identity_number(unsigned number, char identity[IDENTITY_MAX])
{
	size_t len = strlen(identity);

	if (number > 1)
		snprintf(identity + len, IDENTITY_MAX - len, "#%u", number);
}

struct named {
	const char *name;
	unsigned index;
};

static int compare_named(const void *a, const void *b)
{
	const struct named *x = a, *y = b;
	int order = strcmp(x->name, y->name);

	return order ? order : (x->index > y->index) - (x->index < y->index);
}

/* Sort, and report what is there twice; "" was refused already. */
static void check_twice(struct build *build, struct named *sorted, const struct rio_position *names,
                        const char *what)
{
	unsigned count = build->box->config.item_count;

	qsort(sorted, count, sizeof(*sorted), compare_named);
	for (unsigned i = 1, first = 0; i < count; i++) {
		if (strcmp(sorted[i].name, sorted[first].name))
			first = i;
		else if (*sorted[i].name)
			report_error(build->report, names[sorted[i].index],
			             "the %s \"%s\" is given twice, first in line %d", what,
			             sorted[i].name, names[sorted[first].index].line);
	}
}

/*
 * An item without Identity has its path. Of several with one path the first in the file has it, the
 * second path#2: a rename changes none, nor does an item that is added after them.
 */
static void give_identities(struct build *build, struct named *sorted)
{
	const struct config *config = &build->box->config;
	unsigned count = config->item_count;

	for (unsigned i = 0; i < count; i++) {
		const char *given = config->items[i].identity_text;

		/* those that are given come first, so that others step aside */
		sorted[i] = (struct named){given ? given : config->items[i].path,
		                           given ? i : i + count};
	}
	qsort(sorted, count, sizeof(*sorted), compare_named);
	for (unsigned i = 0, first = 0; i < count; i++) {
		const char *identity = sorted[i].name;
		char numbered[IDENTITY_MAX];

		if (strcmp(identity, sorted[first].name))
			first = i;
		if (i > first && *identity && sorted[i].index >= count) {
			snprintf(numbered, sizeof(numbered), "%s", identity);
			identity_number(i - first + 1, numbered);
			identity = build_keep(build, numbered, strlen(numbered));
		}
		config->items[sorted[i].index % count].identity = identity;
	}
}

void items_check(struct build *build, const struct rio_position *names)
{
	const struct config *config = &build->box->config;
	struct named *sorted = calloc(config->item_count + 1, sizeof(*sorted));

	if (!sorted) {
		build->no_memory = true;
		return;
	}
	for (unsigned i = 0; i < config->item_count; i++)
		sorted[i] = (struct named){config->items[i].name, i};
	check_twice(build, sorted, names, "name");
	give_identities(build, sorted);
	for (unsigned i = 0; i < config->item_count; i++)
		sorted[i] = (struct named){config->items[i].identity, i};
	check_twice(build, sorted, names, "identity");
	free(sorted);
}
