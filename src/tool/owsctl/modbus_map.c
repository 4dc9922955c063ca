/* SPDX-License-Identifier: MIT */
/* owsctl modbus-map: which signal owsd-modbus serves at which addresses. */
#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/show/json.h"
#include "src/ground/signal/value.h"
#include "src/tool/owsctl/modbus_map.h"
#include "src/tool/owsctl/table.h"
#include "src/tool/owsctl/verbs.h"

enum form { FORM_TABLE, FORM_CSV, FORM_JSON, FORM_KEEP };

static const struct table_column columns[] = {
	{.title = "PLACE", .right = true},
	{.title = "RECORD", .right = true},
	{.title = "FLOAT32", .right = true},
	{.title = "FLOAT64", .right = true},
	{.title = "NAME"},
	{.title = "TYPE"},
	{.title = "IO"},
	{.title = "UNIT"},
	{.title = "IDENTITY"},
};
#define COLUMNS (sizeof(columns) / sizeof(columns[0]))

/* A place: its numbers as text, then texts; of a signal that is gone they are "". */
static void cells_of(const struct map *map, struct ows *h, unsigned place, char numbers[4][8],
                     const char *cells[COLUMNS])
{
	const unsigned at[] = {place, place * LAYOUT_RECORD, layout_in_row(LAYOUT_FLOAT, place),
	                       layout_in_row(LAYOUT_DOUBLE, place)};
	struct ows_info info = {.name = "", .unit = ""};
	bool has = map->places[place].signal != MAP_NO_SIGNAL &&
	           !ows_info(h, map->places[place].signal, &info);

	for (unsigned i = 0; i < 4; i++) {
		snprintf(numbers[i], sizeof(numbers[i]), "%u", at[i]);
		cells[i] = numbers[i];
	}
	cells[4] = info.name;
	cells[5] = has ? value_type_name((enum ows_type)info.type) : "";
	cells[6] = !has ? "" : info.output ? "output" : "input";
	cells[7] = info.unit;
	cells[8] = map->places[place].identity;
}

static void print_json_row(struct json *json, const char *const *cells)
{
	static const char *const keys[COLUMNS] = {"place", "record", "float32", "float64", "name",
	                                          "type",  "io",     "unit",    "identity"};

	json_object(json, NULL);
	for (unsigned i = 0; i < COLUMNS; i++)
		if (i < 4)
			json_number(json, keys[i], cells[i]);
		else
			json_string(json, keys[i], *cells[i] ? cells[i] : NULL);
	json_object_end(json);
}

/* Each cell in quotes, those in it doubled (RFC 4180). */
static void print_csv_row(const char *const *cells)
{
	for (unsigned i = 0; i < COLUMNS; i++) {
		fputs(i ? ",\"" : "\"", stdout);
		for (const char *c = cells[i]; *c; c++)
			fputs(*c == '"' ? "\"\"" : (char[]){*c, '\0'}, stdout);
		putchar('"');
	}
	putchar('\n');
}

static void print_map(const struct map *map, struct ows *h, enum form form)
{
	const char *cells[COLUMNS];
	char numbers[4][8];
	struct table table;
	struct json json;

	table_init(&table, columns, COLUMNS);
	json_list(&json, stdout, form == FORM_JSON);
	if (form == FORM_CSV)
		puts("place,record,float32,float64,name,type,io,unit,identity");
	for (unsigned place = 1; place <= map->last; place++) {
		if (!map->places[place].identity)
			continue;
		cells_of(map, h, place, numbers, cells);
		if (form == FORM_TABLE)
			table_add(&table, cells);
		else if (form == FORM_JSON)
			print_json_row(&json, cells);
		else if (form == FORM_CSV)
			print_csv_row(cells);
		else
			printf("%u %s\n", place, map->places[place].identity);
	}
	json_list_end(&json);
	if (form == FORM_TABLE)
		table_print(&table, true);
	table_free(&table);
}

/* absent: what helps if it is not there; NULL: it need not be. */
static int read_file(const char *path, const char *absent, struct map *map)
{
	unsigned line;
	int err = map_read(map, path, &line);

	if (err == -ENOENT)
		return absent ? ctl_fail("there is no %s: %s", path, absent) : CTL_DONE;
	if (err == -EINVAL)
		return ctl_fail("%s:%u: no place and identity", path, line);
	return err ? ctl_fail("%s: %s", path, strerror(-err)) : CTL_DONE;
}

/* directory NULL: where owsd-modbus keeps it. */
static int read_map(const struct ctl *ctl, const char *directory, const char *absent,
                    struct map *map)
{
	char path[MAP_PATH];
	int err = 0;

	if (!directory)
		err = map_path_found(ctl->instance, path);
	else if (snprintf(path, sizeof(path), "%s/map", directory) >= (int)sizeof(path))
		err = -ENAMETOOLONG;
	if (err)
		return ctl_fail("the map of %s: %s", ctl->instance, strerror(-err));
	return read_file(path, absent, map);
}

int modbus_map_given(const struct ctl *ctl, const char *fixed, const char *directory,
                     struct map *map)
{
	int status = fixed ? read_file(fixed, "the key Map names it", map) : CTL_DONE;

	return status ? status : read_map(ctl, directory, NULL, map);
}

static void find_signals(struct map *map, struct ows *h)
{
	struct ows_info info;

	for (int i = 0; i < ows_count(h); i++)
		for (unsigned place = 1; !ows_info(h, i, &info) && place <= map->last; place++)
			if (map->places[place].identity &&
			    !strcmp(map->places[place].identity, info.identity))
				map->places[place].signal = i;
}

int verb_modbus_map(struct ctl *ctl, int argc, char **argv)
{
	const char *directory = NULL;
	enum form form = FORM_TABLE;
	static struct map map;
	struct ows *h;
	int c, status;

	while ((c = ctl_option(ctl, argc, argv, "d:Ck")) != -1)
		if (c == 'd')
			directory = optarg;
		else
			form = c == 'C' ? FORM_CSV : FORM_KEEP;
	if (optind < argc)
		return ctl_usage(ctl, "it takes no names");
	if (ctl->json && form != FORM_TABLE)
		return ctl_usage(ctl, "--csv, --keep and --json exclude each other");
	if (ctl->json)
		form = FORM_JSON;
	status = read_map(ctl, directory,
	                  "has owsd-modbus run for this instance, with a Modbus block?", &map);
	if (status)
		return status;
	h = ctl_open(ctl, OWS_READ);
	find_signals(&map, h);
	print_map(&map, h, form);
	map_free(&map);
	ows_close(h);
	return CTL_DONE;
}
