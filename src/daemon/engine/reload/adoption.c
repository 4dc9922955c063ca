/* SPDX-License-Identifier: MIT */
/*
 * Which rows and targets of a configuration stay in a changed one: two configurations are compared.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/check/targets.h"
#include "src/daemon/engine/reload/adoption.h"

/* Is it the same property, read as the same type? */
static int compare_places(const struct config_item *a, const struct config_item *b)
{
	int order = strcmp(a->path, b->path);

	return order ? order : (a->type > b->type) - (a->type < b->type);
}

static int compare_names(const void *a, const void *b)
{
	const struct config_item *x = *(const struct config_item *const *)a;
	const struct config_item *y = *(const struct config_item *const *)b;
	int order = strcmp(x->name, y->name);

	return order ? order : compare_places(x, y);
}

static int compare_identities(const void *a, const void *b)
{
	const struct config_item *x = *(const struct config_item *const *)a;
	const struct config_item *y = *(const struct config_item *const *)b;
	int order = strcmp(x->identity, y->identity);

	return order ? order : compare_places(x, y);
}

/* Rows without a predecessor get the one that compares equal, if nobody has it. */
static void find_rows(struct adoption *plan, const struct config *config,
                      const struct config *before, const struct config_item **sorted,
                      int (*compare)(const void *, const void *))
{
	qsort(sorted, before->item_count, sizeof(*sorted), compare);
	for (unsigned i = 0; i < config->item_count; i++) {
		const struct config_item *item = &config->items[i], **found;
		uint32_t row;

		if (plan->rows[i] != ADOPT_NEW)
			continue;
		found = bsearch(&item, sorted, before->item_count, sizeof(*sorted), compare);
		row = found ? (uint32_t)(*found - before->items) : ADOPT_NEW;
		if (!found || plan->successors[row] != ADOPT_NEW)
			continue;
		plan->rows[i] = row;
		plan->successors[row] = i;
		plan->kept_rows++;
	}
}

/* By the name first: who gives an item another Identity leaves its signal as it is. */
static int plan_rows(struct adoption *plan, const struct config *config,
                     const struct config *before)
{
	const struct config_item **sorted = calloc((size_t)before->item_count + 1, sizeof(*sorted));

	plan->rows = calloc((size_t)config->item_count + 1, sizeof(*plan->rows));
	plan->successors = calloc((size_t)before->item_count + 1, sizeof(*plan->successors));
	if (!sorted || !plan->rows || !plan->successors) {
		free(sorted);
		return -ENOMEM;
	}
	for (unsigned i = 0; i < before->item_count; i++) {
		sorted[i] = &before->items[i];
		plan->successors[i] = ADOPT_NEW;
	}
	for (unsigned i = 0; i < config->item_count; i++)
		plan->rows[i] = ADOPT_NEW;
	find_rows(plan, config, before, sorted, compare_names);
	find_rows(plan, config, before, sorted, compare_identities);
	free(sorted);
	return 0;
}

static bool same_options(const struct config *config, const struct config *before,
                         const char *target)
{
	const struct config_bus *a = config_bus(config, target), *b = config_bus(before, target);

	if (!a || !b)
		return !a && !b;
	if (a->option_count != b->option_count)
		return false;
	for (unsigned i = 0; i < a->option_count; i++)
		if (strcmp(a->options[i].key, b->options[i].key) != 0 ||
		    strcmp(a->options[i].text, b->options[i].text) != 0 ||
		    a->options[i].contents != b->options[i].contents)
			return false;
	return true;
}

/* How many ways the group has that begins at this target. */
static unsigned ways_at(const struct config *config, unsigned first)
{
	unsigned n = 1;

	while (first + n < config->target_count &&
	       config->targets[first + n].group == config->targets[first].group)
		n++;
	return n;
}

static bool same_group(const struct config *config, unsigned a, const struct config *before,
                       unsigned b)
{
	unsigned n = ways_at(config, a);

	if (ways_at(before, b) != n)
		return false;
	for (unsigned i = 0; i < n; i++)
		if (strcmp(config->targets[a + i].text, before->targets[b + i].text) != 0 ||
		    !same_options(config, before, config->targets[a + i].text))
			return false;
	return true;
}

static int plan_ports(struct adoption *plan, const struct config *config,
                      const struct config *before)
{
	unsigned n;

	plan->ports = calloc((size_t)config->target_count + 1, sizeof(*plan->ports));
	plan->port_successors = calloc((size_t)before->target_count + 1,
	                               sizeof(*plan->port_successors));
	if (!plan->ports || !plan->port_successors)
		return -ENOMEM;
	for (unsigned b = 0; b < before->target_count; b++)
		plan->port_successors[b] = -1;
	for (unsigned a = 0; a < config->target_count; a += n) {
		n = ways_at(config, a);
		for (unsigned i = 0; i < n; i++)
			plan->ports[a + i] = -1;
		for (unsigned b = 0; b < before->target_count; b += ways_at(before, b)) {
			if (plan->port_successors[b] >= 0 || !same_group(config, a, before, b))
				continue;
			for (unsigned i = 0; i < n; i++) {
				plan->ports[a + i] = (int)(b + i);
				plan->port_successors[b + i] = (int)(a + i);
			}
			plan->kept_ports += n;
			break;
		}
	}
	return 0;
}

int adoption_plan(struct adoption *plan, const struct config *config, const struct config *before)
{
	int err;

	*plan = (struct adoption){0};
	err = plan_rows(plan, config, before);
	if (!err)
		err = plan_ports(plan, config, before);
	if (err)
		adoption_free(plan);
	return err;
}

void adoption_free(struct adoption *plan)
{
	free(plan->rows);
	free(plan->successors);
	free(plan->ports);
	free(plan->port_successors);
	*plan = (struct adoption){0};
}
