/* SPDX-License-Identifier: MIT */
/* What an item is known by, its name and its identity: each item has others. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/read/identity.h"

void identity_of_path(const struct path *path, char out[IDENTITY_MAX])
{
	const char *rest = path->device.len ? path->device.text : path->property.text;
	char bus[16] = "";

	if (path->bus >= 0)
		snprintf(bus, sizeof(bus), "/bus.%d", path->bus);
	snprintf(out, IDENTITY_MAX, "%s/%s", bus, rest);
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
                        const char *what, const char *remedy)
{
	unsigned count = build->box->config.item_count;

	qsort(sorted, count, sizeof(*sorted), compare_named);
	for (unsigned i = 1, first = 0; i < count; i++) {
		if (strcmp(sorted[i].name, sorted[first].name))
			first = i;
		else if (*sorted[i].name)
			report_error(build->report, names[sorted[i].index],
			             "the %s \"%s\" is given twice, first in line %d: %s", what,
			             sorted[i].name, names[sorted[first].index].line, remedy);
	}
}

static int compare_paths(const void *a, const void *b)
{
	const struct identity *x = *(const struct identity *const *)a;
	const struct identity *y = *(const struct identity *const *)b;
	int order = (x->given != NULL) - (y->given != NULL);

	if (!order)
		order = strcmp(x->given ? x->given : x->path, y->given ? y->given : y->path);
	return order ? order : (x > y) - (x < y);
}

static int compare_given(const void *text, const void *item)
{
	return strcmp(text, (*(const struct identity *const *)item)->given);
}

void identity_text(const struct identity *item, char text[IDENTITY_MAX])
{
	if (item->number > 1)
		snprintf(text, IDENTITY_MAX, "%s#%u", item->path, item->number);
	else
		snprintf(text, IDENTITY_MAX, "%s", item->given ? item->given : item->path);
}

/* sorted: those without Identity by their paths, after them those that have one, by that. */
static void number_identities(struct identity **sorted, unsigned count)
{
	struct identity **given = sorted;
	const struct identity *before = NULL;
	char text[IDENTITY_MAX];

	while (given < sorted + count && !(*given)->given)
		given++;
	for (struct identity **i = sorted; i < given; i++) {
		(*i)->number = before && !strcmp(before->path, (*i)->path) ? before->number : 0;
		before = *i;
		if (!*before->path)
			continue;
		do {
			(*i)->number++;
			identity_text(before, text);
		} while (bsearch(text, given, (size_t)(sorted + count - given), sizeof(*given),
		                 compare_given));
	}
}

int identities_number(struct identity *items, unsigned count)
{
	struct identity **sorted = calloc(count + 1, sizeof(struct identity *));

	if (!sorted)
		return -ENOMEM;
	for (unsigned i = 0; i < count; i++)
		sorted[i] = &items[i];
	qsort(sorted, count, sizeof(struct identity *), compare_paths);
	number_identities(sorted, count);
	free(sorted);
	return 0;
}

static int give_identities(struct build *build)
{
	const struct config *config = &build->box->config;
	struct identity *items = calloc(config->item_count + 1, sizeof(*items));
	char text[IDENTITY_MAX];
	int err;

	for (unsigned i = 0; items && i < config->item_count; i++)
		items[i] = (struct identity){config->items[i].identity_text, config->items[i].path,
		                             0};
	err = items ? identities_number(items, config->item_count) : -ENOMEM;
	for (unsigned i = 0; !err && i < config->item_count; i++) {
		config->items[i].identity = items[i].given ? items[i].given : items[i].path;
		if (items[i].number > 1) {
			identity_text(&items[i], text);
			config->items[i].identity = build_keep(build, text, strlen(text));
		}
	}
	free(items);
	return err;
}

void items_check(struct build *build, const struct rio_position *names)
{
	const struct config *config = &build->box->config;
	struct named *sorted = calloc(config->item_count + 1, sizeof(*sorted));

	if (!sorted || give_identities(build)) {
		build->no_memory = true;
		free(sorted);
		return;
	}
	for (unsigned i = 0; i < config->item_count; i++)
		sorted[i] = (struct named){config->items[i].name, i};
	check_twice(build, sorted, names, "name", "give one of them another Name");
	for (unsigned i = 0; i < config->item_count; i++)
		sorted[i] = (struct named){config->items[i].identity, i};
	check_twice(build, sorted, names, "identity", "give one of them another Identity");
	free(sorted);
}
