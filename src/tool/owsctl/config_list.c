/* SPDX-License-Identifier: MIT */
/* owsctl config FILE list: targets, the driver's keys and the items, as a table or JSON. */
#include <stdio.h>
#include <string.h>

#include "src/config/read/options.h"
#include "src/faces/show/json.h"
#include "src/faces/show/names.h"
#include "src/tool/owsctl/config_list.h"
#include "src/tool/owsctl/table.h"

/* The keys that have columns; each where an item has it otherwise than by default. */
static const enum option shown[] = {OPT_NAME,       OPT_TYPE,        OPT_IO,       OPT_INIT_VALUE,
                                    OPT_SAFE_VALUE, OPT_READABLE,    OPT_WRITABLE, OPT_UNCACHED,
                                    OPT_PER_FACTOR, OPT_STALE_AFTER, OPT_ALARM,    OPT_LIMIT_LL,
                                    OPT_LIMIT_L,    OPT_LIMIT_H,     OPT_LIMIT_HH, OPT_PATH};
#define COLUMNS (sizeof(shown) / sizeof(shown[0]))

static bool is_number(const struct option_def *def)
{
	return def->kind == OPTION_COUNT || def->kind == OPTION_SECONDS ||
	       def->kind == OPTION_NUMBER;
}

static double seconds(int64_t ns)
{
	return (double)ns / 1e9;
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
	char rooms[COLUMNS][VALUE_TEXT_MAX];
	const char *cells[COLUMNS];

	for (size_t i = 0; i < COLUMNS; i++) {
		const struct option_def *def = &option_table[shown[i]];

		table->absent[i] &= option_is_preset(def, item);
		cells[i] = option_is_given(def, item) ? option_text(def, item, rooms[i]) : "-";
	}
	table_add(table, cells);
}

static void config_list_print_table(const struct config *config, char *const *patterns, int count)
{
	struct table_column columns[COLUMNS] = {0};
	struct table table;

	print_driver(config);
	for (size_t i = 0; i < COLUMNS; i++)
		columns[i] = (struct table_column){.title = option_table[shown[i]].key,
		                                   .right = is_number(&option_table[shown[i]])};
	table_init(&table, columns, COLUMNS);
	memset(table.absent, true, sizeof(table.absent));
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
			json_bool(json, def->key, text && !strcmp(text, "on"));
		else if (text && is_number(def))
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
