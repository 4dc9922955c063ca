/* SPDX-License-Identifier: MIT */
/* owsctl modbus-map: which signal owsd-modbus serves at which addresses. */
#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "src/faces/show/json.h"
#include "src/ground/signal/value.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/modbus_forms.h"
#include "src/tool/owsctl/modbus_map.h"
#include "src/tool/owsctl/table.h"
#include "src/tool/owsctl/verbs.h"

static const struct table_column columns[MODBUS_CELL_COUNT] = {
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

/* A place: its numbers as text, then texts; of a signal that is gone they are "". */
static void cells_of(const struct map *map, struct ows *h, unsigned place,
                     char numbers[MODBUS_CELL_TEXTS][8], const char *cells[MODBUS_CELL_COUNT])
{
	const unsigned at[] = {place, place * LAYOUT_RECORD, layout_in_row(LAYOUT_FLOAT, place),
	                       layout_in_row(LAYOUT_DOUBLE, place)};
	static struct ows_info info;
	bool has = map->places[place].signal != MAP_NO_SIGNAL &&
	           !ows_info(h, map->places[place].signal, &info);

	for (unsigned i = 0; i < MODBUS_CELL_TEXTS; i++) {
		snprintf(numbers[i], sizeof(numbers[i]), "%u", at[i]);
		cells[i] = numbers[i];
	}
	cells[MODBUS_CELL_name] = has ? info.name : "";
	cells[MODBUS_CELL_type] = has ? value_type_name((enum ows_type)info.type) : "";
	cells[MODBUS_CELL_io] = !has ? "" : info.output ? "output" : "input";
	cells[MODBUS_CELL_unit] = has ? info.unit : "";
	cells[MODBUS_CELL_identity] = map->places[place].identity;
}

static int by_name(const void *a, const void *b)
{
	return strcasecmp(*(const char *const *)a, *(const char *const *)b);
}

/* The names of all signals by by_name(); for free(). NULL: no memory. */
static const char **sort_names(struct ows *h)
{
	int count = ows_count(h);
	const char **names = calloc((size_t)count + 1, sizeof(*names));
	struct ows_info info;

	for (int i = 0; names && i < count; i++)
		names[i] = ows_info(h, i, &info) ? "" : info.name;
	if (names)
		qsort(names, (size_t)count, sizeof(*names), by_name);
	return names;
}

/* Is there another signal of that name, but for case? */
static bool has_twin(const char **names, int count, const char *name)
{
	const char **at = bsearch(&name, names, (size_t)count, sizeof(*names), by_name);

	return at && ((at > names && !by_name(at - 1, at)) ||
	              (at + 1 < names + count && !by_name(at + 1, at)));
}

static void print_json_row(struct json *json, const char *const *cells)
{
	json_object(json, NULL);
	for (unsigned i = 0; i < MODBUS_CELL_COUNT; i++)
		if (i < MODBUS_CELL_TEXTS)
			json_number(json, modbus_cell_names[i], cells[i]);
		else
			json_string(json, modbus_cell_names[i], *cells[i] ? cells[i] : NULL);
	json_object_end(json);
}

/* form NULL: the table, or JSON. */
static void print_map(const struct map *map, struct ows *h, struct modbus_file *file,
                      const struct modbus_form *form, bool as_json)
{
	const char *cells[MODBUS_CELL_COUNT], **names = form ? sort_names(h) : NULL;
	char numbers[MODBUS_CELL_TEXTS][8];
	struct table table;
	struct json json;

	table_init(&table, columns, MODBUS_CELL_COUNT);
	json_list(&json, stdout, as_json);
	if (form)
		modbus_form_begin(file, form);
	for (unsigned place = 1; place <= map->last; place++) {
		if (!map->places[place].identity)
			continue;
		cells_of(map, h, place, numbers, cells);
		file->twin = names && has_twin(names, ows_count(h), cells[MODBUS_CELL_name]);
		if (form)
			modbus_form_row(file, form, cells);
		else if (as_json)
			print_json_row(&json, cells);
		else
			table_add(&table, cells);
	}
	json_list_end(&json);
	if (form)
		modbus_form_end(file, form);
	else if (!as_json)
		table_print(&table, true);
	table_free(&table);
	free(names);
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

/* Returns how many places have one. */
static unsigned find_signals(struct map *map, struct ows *h)
{
	unsigned count = 0, place;
	struct ows_info info;

	for (int i = 0; i < ows_count(h); i++) {
		place = ows_info(h, i, &info) ? 0 : map_known(map, info.identity);
		if (place)
			map->places[place].signal = i;
		count += place != 0;
	}
	return count;
}

/* HOST, HOST:PORT or [HOST]:PORT. False: it is none; the text is taken to pieces. */
static bool host_and_port(char *text, struct modbus_file *file)
{
	char *colon = strrchr(text, ':');
	int64_t number;

	if (colon && (*text == '[' ? colon[-1] == ']' : strchr(text, ':') == colon)) {
		*colon = '\0';
		file->port = colon + 1;
	}
	if (*text == '[' && text[1] && text[strlen(text) - 1] == ']') {
		text[strlen(text) - 1] = '\0';
		text++;
	}
	file->host = text;
	/* it goes into scripts; and a number of JSON begins with no other digit */
	return *text && *file->port >= '1' && *file->port <= '9' &&
	       !text[strspn(text, "0123456789abcdefghijklmnopqrstuvwxyz"
	                          "ABCDEFGHIJKLMNOPQRSTUVWXYZ.:-_%")] &&
	       ctl_count(file->port, 1, UINT16_MAX, &number);
}

int verb_modbus_map(struct ctl *ctl, int argc, char **argv)
{
	struct modbus_file file = {
		.out = stdout, .instance = ctl->instance, .host = "127.0.0.1", .port = "502"};
	const struct modbus_form *form = NULL;
	const char *directory = NULL;
	static struct map map;
	struct ows *h;
	int c, status;

	while ((c = ctl_option(ctl, argc, argv, "d:A:H:")) != -1) {
		if (c == 'd')
			directory = optarg;
		if (c == 'A' && !(form = modbus_form_find(optarg)))
			return ctl_usage(ctl, "--as %s: one of these expected: %s",
			                 ctl_word(optarg), modbus_form_names());
		if (c == 'H' && !host_and_port(optarg, &file))
			return ctl_usage(ctl, "--host: HOST or HOST:PORT expected");
	}
	if (optind < argc)
		return ctl_usage(ctl, "it takes no names");
	if (ctl->json && form)
		return ctl_usage(ctl, "--as and --json exclude each other");
	status = read_map(ctl, directory,
	                  "has owsd-modbus run for this instance, with a Modbus block?", &map);
	if (status)
		return status;
	h = ctl_open(ctl, OWS_READ);
	file.count = find_signals(&map, h);
	print_map(&map, h, &file, form, ctl->json);
	map_free(&map);
	ows_close(h);
	return CTL_DONE;
}
