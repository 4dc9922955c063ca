/* SPDX-License-Identifier: MIT */
/* The model of a configuration, from the tree of its document. */
#include <ctype.h>
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "hal/owfs/path.h"
#include "src/config/edit/edit_block.h"
#include "src/config/read/options.h"
#include "src/faces/web/model.h"
#include "src/ground/signal/value.h"

static const char *value_of(const struct rio_node *block, enum option option)
{
	const struct rio_node *node = rio_child(block, option_table[option].key);

	return node && node->kind != RIO_BLOCK ? node->value : NULL;
}

static int by_place(const void *a, const void *b)
{
	const struct rio_node *x = *(const struct rio_node *const *)a;
	const struct rio_node *y = *(const struct rio_node *const *)b;

	return (x->begin > y->begin) - (x->begin < y->begin);
}

static int by_key(const void *a, const void *b)
{
	const struct rio_node *x = *(const struct rio_node *const *)a;
	const struct rio_node *y = *(const struct rio_node *const *)b;
	int order = strcmp(x->key, y->key);

	return order ? order : by_place(a, b);
}

/*
 * The settings of a block, of each key the first, in the order of the text. Sorted, because a text
 * may have a hundred thousand keys. NULL: none, or no memory.
 */
static const struct rio_node **settings_of(const struct rio_node *block, size_t *count)
{
	const struct rio_node **all;
	size_t n = 0;

	*count = 0;
	for (const struct rio_node *node = block->first; node; node = node->next)
		n += node->kind != RIO_BLOCK && *node->key;
	all = n ? calloc(n, sizeof(const struct rio_node *)) : NULL;
	if (!all)
		return NULL;
	n = 0;
	for (const struct rio_node *node = block->first; node; node = node->next)
		if (node->kind != RIO_BLOCK && *node->key)
			all[n++] = node;
	qsort(all, n, sizeof(const struct rio_node *), by_key);
	for (size_t i = 0; i < n; i++)
		if (!i || strcmp(all[i]->key, all[*count - 1]->key) != 0)
			all[(*count)++] = all[i];
	qsort(all, *count, sizeof(const struct rio_node *), by_place);
	return all;
}

/* All keys as written, but for those two. */
static void put_keys(struct json *json, const char *name, const struct rio_node *block,
                     enum option without, enum option nor)
{
	size_t count;
	const struct rio_node **settings = settings_of(block, &count);

	json_object(json, name);
	for (size_t i = 0; i < count; i++)
		if (strcmp(settings[i]->key, option_table[without].key) != 0 &&
		    strcmp(settings[i]->key, option_table[nor].key) != 0)
			json_string(json, settings[i]->key, settings[i]->value);
	json_object_end(json);
	free(settings);
}

static void put_targets(struct json *json, const char *text)
{
	json_array(json, "targets");
	for (const char *at = text; at && *at;) {
		size_t len = strcspn(at, ",|"), first = strspn(at, " \t"), end = len;

		while (end > first && (at[end - 1] == ' ' || at[end - 1] == '\t'))
			end--;
		if (end > first)
			json_bytes(json, NULL, at + first, end - first);
		at += len + (at[len] != '\0');
	}
	json_array_end(json);
}

/* Type and direction, whether they are written as such or as bits of IOType. */
static void put_type(struct json *json, const struct rio_node *item)
{
	const char *bits = value_of(item, OPT_IO_TYPE), *type = value_of(item, OPT_TYPE);
	const char *io = value_of(item, OPT_IO), *uncached = value_of(item, OPT_UNCACHED);
	unsigned long code = bits ? strtoul(bits, NULL, strncasecmp(bits, "0x", 2) ? 10 : 16) : 0;
	int64_t fresh = (code & IO_TYPE_UNCACHED) != 0;

	if (!type && value_type_ok((int)(code & IO_TYPE_CODE)))
		type = value_type_name((enum ows_type)(code & IO_TYPE_CODE));
	json_string(json, "type", type);
	json_string(json, "io", io ? io : code & IO_TYPE_OUTPUT ? "output" : "input");
	if (uncached && value_parse(OWS_BOOL, uncached, &fresh))
		fresh = false;
	json_bool(json, "uncached", fresh);
}

static void put_item(struct json *json, const struct rio_node *item)
{
	const char *name = value_of(item, OPT_NAME), *text = value_of(item, OPT_PATH);
	char id[ROM_TEXT_MAX];
	struct path path;
	bool known = text && !path_split(text, strlen(text), &path) && path.has_rom;

	if (known)
		rom_print(path.rom, ROM_F_I, id);
	json_object(json, NULL);
	json_string(json, "name", name ? name : "");
	json_string(json, "path", text ? text : "");
	json_string(json, "device", known ? id : NULL);
	json_int(json, "line", item->at.line);
	put_type(json, item);
	put_keys(json, "keys", item, OPT_NAME, OPT_PATH);
	json_object_end(json);
}

static void put_bus(struct json *json, const struct rio_node *bus)
{
	const char *target = value_of(bus, OPT_BUS_TARGET);

	json_object(json, NULL);
	json_string(json, "target", target ? target : "");
	json_int(json, "line", bus->at.line);
	put_keys(json, "keys", bus, OPT_BUS_TARGET, OPT_BUS_TARGET);
	json_object_end(json);
}

static bool is_first(const struct rio_node *block, const struct rio_node *node)
{
	return rio_child(block, node->key) == node;
}

/* The blocks of one kind. */
static void put_all(struct json *json, const char *name, const struct rio_node *driver,
                    enum option option, void (*put)(struct json *, const struct rio_node *))
{
	json_array(json, name);
	for (const struct rio_node *node = driver->first; node; node = node->next)
		if (option_is_block(node, option))
			put(json, node);
	json_array_end(json);
}

void model_json(struct json *json, const struct rio *rio)
{
	static const struct rio_node none;
	const struct rio_node *driver = edit_driver(rio);

	if (!driver)
		driver = &none;
	json_object(json, "model");
	put_targets(json, value_of(driver, OPT_TARGET_NAME));
	put_keys(json, "driver", driver, OPT_ITEM, OPT_ITEM);
	json_object(json, "blocks");
	for (const struct rio_node *node = driver->first; node; node = node->next)
		if (node->kind == RIO_BLOCK && option_single(node->key) && is_first(driver, node))
			put_keys(json, node->key, node, OPT_ITEM, OPT_ITEM);
	json_object_end(json);
	put_all(json, "buses", driver, OPT_BUS, put_bus);
	put_all(json, "items", driver, OPT_ITEM, put_item);
	json_object_end(json);
}

/* --- The table ------------------------------------------------------------------------------- */

static void put_limit(struct json *json, const char *name, const struct option_def *def,
                      double limit)
{
	char text[VALUE_TEXT_MAX];

	if (def->least >= def->most || limit >= DBL_MAX) {
		json_null(json, name);
		return;
	}
	value_to_text(OWS_DOUBLE, value_of_double(limit), text);
	json_number(json, name, text);
}

void model_keys(struct json *json)
{
	static const char *const kinds[] = {
		[OPTION_TEXT] = "text",     [OPTION_COUNT] = "count", [OPTION_SECONDS] = "seconds",
		[OPTION_NUMBER] = "number", [OPTION_FLAG] = "flag",   [OPTION_TYPE] = "type",
		[OPTION_IO] = "io",         [OPTION_BLOCK] = NULL,
	};

	char place[RIO_KEY_MAX + 1];

	json_array(json, "keys");
	for (int i = 0; i < OPTION_COUNT_ALL; i++) {
		const struct option_def *def = &option_table[i];

		if (def->kind == OPTION_BLOCK)
			continue;
		snprintf(place, sizeof(place), "%s",
		         def->place == PLACE_DRIVER ? "driver" : option_place_name(def->place));
		place[0] = (char)tolower((unsigned char)place[0]);
		json_object(json, NULL);
		json_string(json, "place", place);
		json_string(json, "key", def->key);
		json_string(json, "kind", kinds[def->kind]);
		json_string(json, "default", def->preset);
		put_limit(json, "least", def, def->least);
		put_limit(json, "most", def, def->most);
		json_bool(json, "repeats", def->repeats);
		json_string(json, "help", def->help);
		json_bool(json, "empty", def->empty);
		json_object_end(json);
	}
	json_array_end(json);
}
