/* SPDX-License-Identifier: MIT */
/*
 * Which rows and targets of a configuration stay in a changed one: two configurations are compared.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/check/targets.h"
#include "src/daemon/engine/reload/adoption.h"

static int compare_items(const struct config_item *a, const struct config_item *b)
{
	int order = strcmp(a->name, b->name);

	if (!order)
		order = strcmp(a->path, b->path);
	return order ? order : (a->type > b->type) - (a->type < b->type);
}

static int compare_places(const void *a, const void *b)
{
	return compare_items(*(const struct config_item *const *)a,
	                     *(const struct config_item *const *)b);
}

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
	for (unsigned i = 0; i < before->item_count; i++)
		sorted[i] = &before->items[i];
	for (unsigned i = 0; i < before->item_count; i++)
		plan->successors[i] = ADOPT_NEW;
	qsort(sorted, before->item_count, sizeof(*sorted), compare_places);
	for (unsigned i = 0; i < config->item_count; i++) {
		const struct config_item *item = &config->items[i];
		const struct config_item **found = bsearch(&item, sorted, before->item_count,
		                                           sizeof(*sorted), compare_places);

		plan->rows[i] = ADOPT_NEW;
		if (!found)
			continue;
		plan->rows[i] = (uint32_t)(*found - before->items);
		plan->successors[plan->rows[i]] = i;
		plan->kept_rows++;
	}
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
