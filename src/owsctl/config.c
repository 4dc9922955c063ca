/* SPDX-License-Identifier: MIT */
/* owsctl config: look at a configuration file and edit it as the manual's dialog does. */
#include "json.h"
#include "table.h"
#include "verbs.h"
#include "../config/edit.h"
#include "../signal/value.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct table_column columns[] = {
	{"NAME"}, {"TYPE"}, {"IO"}, {"INIT"}, {"READ"}, {"WRITE"}, {"UNCACHED"}, {"ALARM"}, {"PATH"},
};

static void say(void *ctx, bool is_error, const char *message)
{
	(void)ctx;
	(void)is_error;
	fprintf(stderr, "owsctl: %s\n", message);
}

static const char *yes(bool flag)
{
	return flag ? "on" : "off";
}

static bool print_table(const struct config *config)
{
	struct table table;
	char line[8192];
	bool ok = true;

	for (unsigned i = 0; i < config->target_count; i++)
		printf("%s%s", config->targets[i].relation == CONFIG_FIRST   ? "target "
		               : config->targets[i].relation == CONFIG_COMMA ? ", "
		                                                             : " | ",
		       config->targets[i].text);
	printf("\nconsecutive alarms %u, retries %u, time-out %g s, period %g s\n\n",
	       config->max_cons_alarms, config->max_retries, (double)config->timeout_ns / 1e9,
	       (double)config->period_ns / 1e9);
	table_init(&table, columns, sizeof(columns) / sizeof(columns[0]));
	for (unsigned i = 0; ok && i < config->item_count; i++) {
		const struct config_item *item = &config->items[i];

		ok = table_add(&table, (const char *const[]){
		                               item->name, value_type_name(item->type),
		                               item->output ? "output" : "input", item->init_text,
		                               yes(item->readable), yes(item->writable),
		                               yes(item->fresh), yes(item->alarm), item->path});
	}
	table_fit(&table, 0);
	for (int i = -1; ok && i < (int)config->item_count; i++) {
		table_line(&table, i, line, sizeof(line));
		puts(line);
	}
	table_free(&table);
	return ok;
}

static void item_json(struct json *json, const struct config_item *item)
{
	json_object(json, NULL);
	json_string(json, "name", item->name);
	json_string(json, "path", item->path);
	json_string(json, "type", value_type_name(item->type));
	json_string(json, "io", item->output ? "output" : "input");
	json_string(json, "init_value", item->has_init ? item->init_text : NULL);
	json_string(json, "safe_value", item->has_safe ? item->safe_text : NULL);
	json_bool(json, "readable", item->readable);
	json_bool(json, "writable", item->writable);
	json_bool(json, "uncached", item->fresh);
	json_uint(json, "per_factor", item->per_factor);
	json_seconds(json, "stale_after", item->stale_after_ns);
	json_bool(json, "alarm", item->alarm);
	json_string(json, "latch_alarm", item->latch_alarm);
	json_string(json, "por_alarm", item->por_alarm);
	json_string(json, "set_alarm", item->set_alarm);
	json_string(json, "reset_latch", item->reset_latch);
	json_int(json, "line", item->line);
	json_object_end(json);
}

static void print_json(const struct config *config)
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
	json_uint(&json, "max_cons_alarms", config->max_cons_alarms);
	json_uint(&json, "max_retries", config->max_retries);
	json_seconds(&json, "timeout", config->timeout_ns);
	json_seconds(&json, "period", config->period_ns);
	json_seconds(&json, "alarm_period", config->alarm_period_ns);
	json_array(&json, "items");
	for (unsigned i = 0; i < config->item_count; i++)
		item_json(&json, &config->items[i]);
	json_array_end(&json);
	json_object_end(&json);
	json_end(&json);
}

/* What was wrong has been said, but for memory. */
static int status_of(int err)
{
	if (!err)
		return CTL_DONE;
	if (err == -ENOMEM)
		return ctl_fail("no memory");
	return err == -EINVAL ? CTL_USAGE : CTL_FAILED;
}

static int list(struct ctl *ctl, const char *file)
{
	struct config_report report = {.line = say};
	struct config *config;
	int err = config_load(file, &report, &config), status = CTL_DONE;

	if (err)
		return err == -ENOMEM ? CTL_FAILED : status_of(err);
	if (ctl->json)
		print_json(config);
	else if (!print_table(config))
		status = ctl_fail("no memory");
	config_free(config);
	return status;
}

/* The document to edit; only add makes a file that is not there. */
static int open_document(const char *file, bool make, struct config_report *report,
                         struct rio **rio)
{
	char *text = NULL;
	size_t len;
	int err;

	*rio = NULL;
	if (make && access(file, F_OK) && errno == ENOENT)
		return rio_parse(file, edit_empty, strlen(edit_empty), report, rio);
	err = rio_read(file, report, &text, &len);
	if (err)
		return err == -EFBIG ? -EINVAL : err;
	err = rio_parse(file, text, len, report, rio);
	free(text);
	return err ? err : report->errors ? -EINVAL : 0;
}

/* settings and the like are read only */
static const char *const *words_of(char **argv)
{
	return (const char *const *)(void *)argv;
}

static int change(const char *file, const char *action, char **words, unsigned count)
{
	struct config_report report = {.line = say};
	struct rio *rio;
	int lock = edit_lock(file, &report), err;

	if (lock < 0)
		return CTL_FAILED;
	err = open_document(file, !strcmp(action, "add"), &report, &rio);
	if (!err && !strcmp(action, "add"))
		err = edit_add(&rio, words[0], words[1], words_of(words + 2), count - 2, &report);
	else if (!err && !strcmp(action, "set"))
		err = edit_set(&rio, words[0], words_of(words + 1), count - 1, &report);
	else if (!err && !strcmp(action, "unset"))
		err = edit_unset(&rio, words[0], words_of(words + 1), count - 1, &report);
	else
		for (unsigned i = 0; i < count && !err; i++)
			err = edit_remove(&rio, words[i], &report);
	if (!err)
		err = edit_commit(rio, file, &report);
	rio_free(rio);
	close(lock);
	if (err == -EFBIG && !report.errors)
		return ctl_fail("%s would be longer than %u bytes", file, RIO_FILE_MAX);
	return status_of(err);
}

/* Options behind list too: it has no words of its own. */
static int list_with(struct ctl *ctl, const char *file, int argc, char **argv)
{
	ctl_options();
	if (ctl_option(ctl, argc, argv, "") != -1)
		return CTL_USAGE;
	if (optind < argc)
		return ctl_usage(ctl, "expected config FILE list");
	return list(ctl, file);
}

int verb_config(struct ctl *ctl, int argc, char **argv)
{
	static const struct {
		const char *name, *words;
		int least;
	} actions[] = {
		{"list", "", 0},
		{"add", " NAME PATH [KEY=VALUE]...", 2},
		{"set", " NAME KEY=VALUE...", 2},
		{"unset", " NAME KEY...", 2},
		{"remove", " NAME...", 1},
	};
	const char *file, *action;
	int words;

	ctl_options();
	if (ctl_option(ctl, argc, argv, "+") != -1)
		return CTL_USAGE;
	file = argv[optind];
	if (argc - optind < 2)
		return ctl_usage(ctl, "expected a file and list, add, set, unset or remove");
	action = argv[optind + 1];
	words = argc - optind - 2;
	for (size_t i = 0; i < sizeof(actions) / sizeof(actions[0]); i++) {
		if (strcmp(actions[i].name, action) != 0)
			continue;
		if (!actions[i].least)
			return list_with(ctl, file, argc - optind - 1, argv + optind + 1);
		if (words < actions[i].least)
			return ctl_usage(ctl, "expected config FILE %s%s", action, actions[i].words);
		return change(file, action, argv + optind + 2, (unsigned)words);
	}
	return ctl_usage(ctl, "there is no config %s", action);
}
