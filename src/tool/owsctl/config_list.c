/* SPDX-License-Identifier: MIT */
/* owsctl config FILE list: targets, the driver's keys and the items, as a table or JSON. */
#include <stdio.h>
#include <string.h>

#include "src/config/read/options.h"
#include "src/faces/show/json.h"
#include "src/faces/show/names.h"
#include "src/tool/owsctl/config_list.h"
#include "src/tool/owsctl/table.h"

enum {
	NAME,
	TYPE,
	IO,
	INIT,
	SAFE,
	READ,
	WRITE,
	UNCACHED,
	PER_FACTOR,
	STALE_AFTER,
	ALARM,
	LIMITS,
	PATH,
	COLUMNS,
};
/* clang-format off */
static const struct table_column columns[COLUMNS] = {
	[NAME] = {"NAME"}, [TYPE] = {"TYPE"}, [IO] = {"IO"}, [INIT] = {"INIT"}, [SAFE] = {"SAFE"},
	[READ] = {"READ"}, [WRITE] = {"WRITE"}, [UNCACHED] = {"UNCACHED"},
	[PER_FACTOR] = {"PERFACTOR", .right = true}, [STALE_AFTER] = {"STALE", .right = true},
	[ALARM] = {"ALARM"}, [LIMITS] = {"LIMITS"}, [PATH] = {"PATH"},
};
/* clang-format on */

static const char *yes(bool flag)
{
	return flag ? "on" : "off";
}

static double seconds(int64_t ns)
{
	return (double)ns / 1e9;
}

#define LIMITS_TEXT 320
/* "LL -40, H -15; hysteresis 1, on delay 300 s"; "-" without limits. Returns text. */
static const char *limits_text(const struct config_limits *limits, char text[LIMITS_TEXT])
{
	static const char *const names[CONFIG_LIMITS] = {
		[CONFIG_LIMIT_LL] = "LL",
		[CONFIG_LIMIT_L] = "L",
		[CONFIG_LIMIT_H] = "H",
		[CONFIG_LIMIT_HH] = "HH",
	};
	int used = 0;

	snprintf(text, LIMITS_TEXT, "-");
	for (int i = 0; i < CONFIG_LIMITS; i++)
		if (limits->has[i])
			used += snprintf(text + used, LIMITS_TEXT - (size_t)used, "%s%s %.10g",
			                 used ? ", " : "", names[i], limits->limit[i]);
	if (used && limits->hysteresis > 0)
		used += snprintf(text + used, LIMITS_TEXT - (size_t)used, ", hysteresis %.10g",
		                 limits->hysteresis);
	if (used && limits->on_delay_ns)
		used += snprintf(text + used, LIMITS_TEXT - (size_t)used, ", on delay %g s",
		                 seconds(limits->on_delay_ns));
	if (used && limits->off_delay_ns)
		snprintf(text + used, LIMITS_TEXT - (size_t)used, ", off delay %g s",
		         seconds(limits->off_delay_ns));
	return text;
}

static void print_driver(const struct config *config)
{
	for (unsigned i = 0; i < config->target_count; i++)
		printf("%s%s",
		       config->targets[i].relation == CONFIG_FIRST   ? "target "
		       : config->targets[i].relation == CONFIG_COMMA ? ", "
		                                                     : " | ",
		       config->targets[i].text);
	printf("\nconsecutive alarms %u, retries %u, time-out %g s, period %g s\n\n",
	       config->max_cons_alarms, config->max_retries, seconds(config->timeout_ns),
	       seconds(config->period_ns));
}

static void config_list_add_row(struct table *table, const struct config_item *item)
{
	char per_factor[16], stale[32] = "-", limits[LIMITS_TEXT];

	snprintf(per_factor, sizeof(per_factor), "%u", (unsigned)item->per_factor);
	if (item->stale_after_ns)
		snprintf(stale, sizeof(stale), "%gs", seconds(item->stale_after_ns));
	/* leave out columns that have nothing for any item */
	table->absent[SAFE] &= !item->has_safe;
	table->absent[PER_FACTOR] &= item->per_factor == 1;
	table->absent[STALE_AFTER] &= !item->stale_after_ns;
	table->absent[LIMITS] &= !item->limits.any;
	table_add(table,
	          (const char *const[COLUMNS]){[NAME] = item->name,
	                                       [TYPE] = value_type_name(item->type),
	                                       [IO] = item->output ? "output" : "input",
	                                       [INIT] = item->init_text,
	                                       [SAFE] = item->has_safe ? item->safe_text : "-",
	                                       [READ] = yes(item->readable),
	                                       [WRITE] = yes(item->writable),
	                                       [UNCACHED] = yes(item->fresh),
	                                       [PER_FACTOR] = per_factor,
	                                       [STALE_AFTER] = stale,
	                                       [ALARM] = yes(item->alarm),
	                                       [LIMITS] = limits_text(&item->limits, limits),
	                                       [PATH] = item->path});
}

static void config_list_print_table(const struct config *config, char *const *patterns, int count)
{
	struct table table;

	print_driver(config);
	table_init(&table, columns, COLUMNS);
	table.absent[SAFE] = table.absent[PER_FACTOR] = table.absent[STALE_AFTER] =
		table.absent[LIMITS] = true;
	for (unsigned i = 0; i < config->item_count; i++)
		if (names_match(config->items[i].name, patterns, count))
			config_list_add_row(&table, &config->items[i]);
	table_print(&table, true);
	table_free(&table);
}

/* All keys of a block, as the file calls them, with the values in force; null: there is none. */
static void keys_json(struct json *json, enum option_place place, const void *from)
{
	char room[VALUE_TEXT_MAX];

	for (int i = 0; i < OPTION_COUNT_ALL; i++) {
		const struct option_def *def = &option_table[i];
		const char *text;

		if (def->place != place || !def->store)
			continue;
		text = option_is_given(def, from) ? option_text(def, from, room) : NULL;
		if (def->kind == OPTION_FLAG)
			json_bool(json, def->key, !strcmp(text, "on"));
		else if (text && (def->kind == OPTION_COUNT || def->kind == OPTION_SECONDS ||
		                  def->kind == OPTION_NUMBER))
			json_number(json, def->key, text);
		else
			json_string(json, def->key, text);
	}
}

static void item_json(struct json *json, const struct config_item *item)
{
	json_object(json, NULL);
	keys_json(json, PLACE_ITEM, item);
	json_int(json, "line", item->line);
	json_object_end(json);
}

static void config_list_print_json(const struct config *config, char *const *patterns, int count)
{
	static const char *const relations[] = {
		[CONFIG_FIRST] = "first",
		[CONFIG_COMMA] = "wire",
		[CONFIG_BAR] = "way",
	};
	struct json json;

	json_open(&json, stdout);
	json_object(&json, NULL);
	json_string(&json, "file", config->file);
	json_array(&json, "targets");
	for (unsigned i = 0; i < config->target_count; i++) {
		json_object(&json, NULL);
		json_string(&json, "target", config->targets[i].text);
		json_string(&json, "relation", relations[config->targets[i].relation]);
		json_object_end(&json);
	}
	json_array_end(&json);
	keys_json(&json, PLACE_DRIVER, config);
	json_array(&json, "items");
	for (unsigned i = 0; i < config->item_count; i++)
		if (names_match(config->items[i].name, patterns, count))
			item_json(&json, &config->items[i]);
	json_array_end(&json);
	json_object_end(&json);
	json_end(&json);
}

int config_list(const struct config *config, char *const *patterns, int count, bool json)
{
	bool some = count == 0;

	for (unsigned i = 0; i < config->item_count && !some; i++)
		some = names_match(config->items[i].name, patterns, count);
	if (!some)
		return ctl_fail("no item matches");
	if (json)
		config_list_print_json(config, patterns, count);
	else
		config_list_print_table(config, patterns, count);
	return CTL_DONE;
}
