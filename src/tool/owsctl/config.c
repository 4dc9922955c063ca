/* SPDX-License-Identifier: MIT */
/* owsctl config: look at a configuration file and edit it as the manual's dialog does. */
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/config/check/know.h"
#include "src/config/check/property.h"
#include "src/config/edit/commit.h"
#include "src/config/edit/edit.h"
#include "src/config/edit/print.h"
#include "src/config/edit/replace.h"
#include "src/config/read/load.h"
#include "src/config/read/options.h"
#include "src/config/read/rio_file.h"
#include "src/faces/show/json.h"
#include "src/faces/show/names.h"
#include "src/ground/text/distance.h"
#include "src/memory/shm/segment.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/machine/faces.h"
#include "src/tool/owsctl/running.h"
#include "src/tool/owsctl/table.h"
#include "src/tool/owsctl/verbs.h"

/* --- list: targets, the keys of the driver and the items ------------------------------------- */

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

/*
 * Show the items whose names match a pattern (without patterns: all), as a table or JSON. Returns
 * the exit status.
 */
static int config_list(const struct config *config, char *const *patterns, int count, bool json)
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

/* --- The file -------------------------------------------------------------------------------- */

/* All errors but -ENOMEM are already printed. */
static int status_of(int err)
{
	if (!err)
		return CTL_DONE;
	if (err == -ENOMEM)
		return ctl_fail("no memory");
	return err == -EINVAL ? CTL_USAGE : CTL_FAILED;
}

/* Each item that is named, with all its fields. */
static int config_show(const struct config *config, char *const *names, int count)
{
	int status = count ? CTL_DONE : ctl_fail("show which item? config FILE list has them");

	for (int k = 0; k < count; k++) {
		unsigned best = text_too_far(names[k]), i = 0;
		const char *nearest = NULL;

		for (; i < config->item_count && strcmp(config->items[i].name, names[k]) != 0; i++)
			if (text_nearer(names[k], config->items[i].name, &best))
				nearest = config->items[i].name;
		if (i < config->item_count)
			config_print_item(&config->items[i], true, stdout);
		else if (!strcmp(names[k], "OwsDrv"))
			status = ctl_fail("OwsDrv has the items: owsd --check -c FILE prints it");
		else
			status = ctl_fail("there is no item \"%s\"%s%s%s", names[k],
			                  nearest ? "; did you mean \"" : "",
			                  nearest ? nearest : "", nearest ? "\"?" : "");
	}
	return status;
}

/* list and show: both with --json are the same. */
static int list_file(struct ctl *ctl, const char *file, bool whole, char *const *patterns,
                     int count)
{
	/* warnings are the business of owsd --check, unless the file is edited */
	struct config_report report = {.line = ctl_report};
	struct config *config;
	int err = config_load(file, &report, &config), status;

	if (err)
		return err == -ENOMEM ? CTL_FAILED : status_of(err);
	config_know(config);
	status = whole && !ctl->json ? config_show(config, patterns, count)
	                             : config_list(config, patterns, count, ctl->json);
	config_free(config);
	return status;
}

/* Open the document to edit; with `make`, which `add` alone sets, a missing file is empty. */
static int open_document(const char *file, bool make, struct config_report *report,
                         struct rio **rio)
{
	char *text = NULL;
	struct stat st;
	size_t len;
	int err;

	*rio = NULL;
	/* a link that leads nowhere is not new */
	if (make && lstat(file, &st) && errno == ENOENT) {
		ctl_tell("%s is new, with the target localhost:4304: config FILE set OwsDrv "
		         "TargetName=... changes it",
		         file);
		return rio_parse(file, edit_empty, strlen(edit_empty), report, rio);
	}
	err = rio_read(file, report, &text, &len);
	if (err)
		return err == -EFBIG ? -EINVAL : err;
	err = rio_parse(file, text, len, report, rio);
	free(text);
	return err ? err : report->errors ? -EINVAL : 0;
}

/*
 * Does the device's family have the property that a new path names? A name that is nearly a
 * property is refused. Any other name is accepted: another server may know more properties than
 * owsd.
 */
static int check_path(const char *path)
{
	struct path_property found = property_look(path);

	if (found.exists || !*found.nearest)
		return 0;
	ctl_fail("%s: its family has no such property; did you mean %s?", path, found.nearest);
	return -EINVAL;
}

static int check_paths(const char *action, char **words, unsigned count)
{
	bool adds = !strcmp(action, "add");
	int err = adds ? check_path(words[1]) : 0;

	if (!adds && strcmp(action, "set") != 0)
		return 0;
	for (unsigned i = adds ? 2 : 1; i < count && !err; i++)
		if (!strncmp(words[i], "Path=", 5))
			err = check_path(words[i] + 5);
	return err;
}

/* the words of commands that only read are not changed */
static const char *const *words_of(char **argv)
{
	return (const char *const *)(void *)argv;
}

/* The program that reads the block; NULL: owsd does. */
static const struct face_row *reader_of(const char *block, struct face_row rows[FACE_ROWS])
{
	char word[sizeof(rows->program)];

	if (!isupper((unsigned char)*block))
		return NULL;
	snprintf(word, sizeof(word), "%c%.20s", tolower((unsigned char)*block), block + 1);
	return faces_find(rows, faces_table(rows), word);
}

/* Who runs does not notice the change by itself. */
static void hint_at_reload(const char *file, const char *changed)
{
	struct face_row rows[FACE_ROWS];
	const struct face_row *face = reader_of(changed, rows);
	char name[SEGMENT_NAME_MAX + 1], instance[SEGMENT_NAME_MAX + 5] = "";

	if (!instance_of_file(file, name))
		return;
	if (strcmp(name, "OWS") != 0)
		snprintf(instance, sizeof(instance), "-n %s ", name);
	if (face)
		ctl_tell("%s goes on as before until you run: sudo owsctl %senable %s",
		         face->program, instance, face->program + strlen("owsd-"));
	else
		ctl_tell("owsd %s goes on as before until you run: %sowsctl %sreload", name,
		         strncmp(file, CONFIG_DIR "/", strlen(CONFIG_DIR "/")) ? "" : "sudo ",
		         instance);
}

static int change_file(const char *file, const char *action, char **words, unsigned count)
{
	struct config_report report = {.line = ctl_report, .ctx = &report};
	struct rio *rio;
	int lock = edit_lock(file, &report), err;

	if (lock < 0)
		return CTL_FAILED;
	err = open_document(file, !strcmp(action, "add"), &report, &rio);
	if (!err)
		err = check_paths(action, words, count);
	if (!err && !strcmp(action, "move"))
		err = edit_move(&rio, words[0], words[2], !strcmp(words[1], "--after"), &report);
	else if (!err && !strcmp(action, "add"))
		err = edit_add(&rio, words[0], words[1], words_of(words + 2), count - 2, &report);
	else if (!err && !strcmp(action, "set"))
		err = edit_set(&rio, words[0], words_of(words + 1), count - 1, &report);
	else if (!err && !strcmp(action, "rename"))
		err = edit_rename(&rio, words[0], words[1], &report);
	else if (!err && !strcmp(action, "unset"))
		err = edit_unset(&rio, words[0], words_of(words + 1), count - 1, &report);
	else
		for (unsigned i = 0; i < count && !err; i++)
			err = edit_remove(&rio, words[i], &report);
	if (!err)
		err = edit_commit(rio, file, words[!strcmp(action, "rename")], &report);
	rio_free(rio);
	replace_unlock(file, lock);
	if (!err)
		hint_at_reload(file, words[0]);
	if (err == -EFBIG && !report.errors)
		return ctl_fail("%s would be longer than %u bytes", file, RIO_FILE_MAX);
	return status_of(err);
}

/* Run `list` or `show`: options may follow the word too, and patterns or names. */
static int list_with(struct ctl *ctl, const char *file, int argc, char **argv)
{
	optind = 0;
	ctl_option(ctl, argc, argv, "");
	return list_file(ctl, file, !strcmp(argv[0], "show"), argv + optind, argc - optind);
}

int verb_config(struct ctl *ctl, int argc, char **argv)
{
	static const struct {
		const char *name, *words;
		int least;
	} actions[] = {
		{"list", "", 0},
		{"show", "", 0},
		{"add", " NAME PATH [KEY=VALUE]...", 2},
		{"set", " NAME KEY=VALUE...", 2},
		{"rename", " NAME NEW", 2},
		{"unset", " NAME KEY...", 2},
		{"remove", " NAME...", 1},
		{"move", " NAME --before OTHER | --after OTHER", 3},
	};
	const char *file, *action;
	int words;

	ctl_option(ctl, argc, argv, "+");
	for (int i = optind; i < argc; i++)
		if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h")) {
			ctl_help(ctl->verb, stdout);
			return CTL_DONE;
		}
	file = argv[optind];
	if (argc - optind < 2)
		return ctl_usage(
			ctl,
			"expected a file and list, show, add, set, rename, unset, remove or move");
	action = argv[optind + 1];
	words = argc - optind - 2;
	for (size_t i = 0; i < sizeof(actions) / sizeof(actions[0]); i++) {
		if (strcmp(actions[i].name, action) != 0)
			continue;
		if (!actions[i].least)
			return list_with(ctl, file, argc - optind - 1, argv + optind + 1);
		if (words < actions[i].least || (!strcmp(action, "rename") && words > 2) ||
		    (!strcmp(action, "move") &&
		     (words != 3 || (strcmp(argv[optind + 3], "--before") != 0 &&
		                     strcmp(argv[optind + 3], "--after") != 0))))
			return ctl_usage(ctl, "expected config FILE %s%s", action,
			                 actions[i].words);
		return change_file(file, action, argv + optind + 2, (unsigned)words);
	}
	return ctl_usage(ctl, "there is no config %s", action);
}
