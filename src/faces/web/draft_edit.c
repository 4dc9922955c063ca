/* SPDX-License-Identifier: MIT */
/* The edits of a draft, by their names. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/config/edit/edit.h"
#include "src/config/edit/edit_block.h"
#include "src/config/edit/edit_device.h"
#include "src/faces/web/draft_edit.h"

#define STEPS_NS (10 * NS_PER_S) /* others wait, and so does the end of owsd-web */

/* The name of a block, and its keys, or settings. */
struct order {
	const char *name;
	char *lines; /* of keys, with NUL in place of line ends */
	const char *keys[DRAFT_SETTINGS];
	unsigned count;
	const struct body *body;
};

static int draft_edit_add(struct rio **rio, const struct order *order, struct config_report *report)
{
	return edit_add(rio, order->name, body_string(order->body, "path"), order->keys,
	                order->count, report);
}

static int set(struct rio **rio, const struct order *order, struct config_report *report)
{
	return edit_set(rio, order->name, order->keys, order->count, report);
}

static int unset(struct rio **rio, const struct order *order, struct config_report *report)
{
	return edit_unset(rio, order->name, order->keys, order->count, report);
}

static int take_out(struct rio **rio, const struct order *order, struct config_report *report)
{
	return edit_remove(rio, order->name, report);
}

static int move(struct rio **rio, const struct order *order, struct config_report *report)
{
	const char *where = body_string(order->body, "where");

	if (strcmp(where, "before") != 0 && strcmp(where, "after") != 0) {
		report_error(report, (struct rio_position){0},
		             "expected \"where\": before or after");
		return -EINVAL;
	}
	return edit_move(rio, order->name, body_string(order->body, "other"),
	                 strcmp(where, "after") == 0, report);
}

static bool take_id(const struct body *body, const char *key, uint8_t rom[ROM_LEN],
                    struct config_report *report)
{
	const char *text = body_string(body, key);

	if (rom_parse(text, strlen(text), rom) == 0)
		return true;
	report_error(report, (struct rio_position){0},
	             "\"%s\": \"%s\" is no id of a device, such as 28.551DDF030000", key, text);
	return false;
}

static int replace(struct rio **rio, const struct order *order, struct config_report *report)
{
	uint8_t old[ROM_LEN], new[ROM_LEN];

	if (!take_id(order->body, "old", old, report) || !take_id(order->body, "new", new, report))
		return -EINVAL;
	return edit_replace(rio, old, new, body_string(order->body, "location"), report);
}

static int targets(struct rio **rio, const struct order *order, struct config_report *report)
{
	const char *setting = NULL;
	char *text;
	int err;

	if (asprintf(&text, "%s=%s", option_table[OPT_TARGET_NAME].key,
	             body_string(order->body, "value")) < 0)
		return -ENOMEM;
	setting = text;
	err = edit_set(rio, EDIT_DRIVER, &setting, 1, report);
	free(text);
	return err;
}

static int begin_anew(struct rio **rio, const struct order *order, struct config_report *report)
{
	struct rio *made;
	int err = rio_parse((*rio)->root.at.file, edit_empty, strlen(edit_empty), report, &made);

	(void)order;
	if (err)
		return err;
	rio_free(*rio);
	*rio = made;
	return 0;
}

static int leave(struct rio **rio, const struct order *order, struct config_report *report)
{
	(void)rio;
	(void)order;
	(void)report;
	return 0;
}

static const struct edit {
	const char *name;
	int (*run)(struct rio **rio, const struct order *order, struct config_report *report);
	bool named; /* of a block: "name" */
	bool bus;   /* of a Bus block: "target" */
	bool keyed; /* with at least one of "keys" */
} edits[] = {
	{.name = "check", .run = leave},
	{.name = "add", .run = draft_edit_add, .named = true},
	{.name = "set", .run = set, .named = true, .keyed = true},
	{.name = "rename", .run = set, .named = true, .keyed = true},
	{.name = "unset", .run = unset, .named = true, .keyed = true},
	{.name = "remove", .run = take_out, .named = true},
	{.name = "move", .run = move, .named = true},
	{.name = "replace", .run = replace},
	{.name = "bus-set", .run = set, .bus = true, .keyed = true},
	{.name = "bus-unset", .run = unset, .bus = true, .keyed = true},
	{.name = "bus-remove", .run = take_out, .bus = true},
	{.name = "targets", .run = targets},
	{.name = "new", .run = begin_anew},
};
#define EDITS (sizeof(edits) / sizeof(edits[0]))

static int draft_edit_refuse(struct config_report *report, const char *what)
{
	report_error(report, (struct rio_position){0}, "%s", what);
	return -EINVAL;
}

/* One setting in each line. */
static int split(struct order *order, const char *keys, struct config_report *report)
{
	char *at, *end;

	order->lines = at = strdup(keys);
	if (!at)
		return -ENOMEM;
	for (; at && *at; at = end ? end + 1 : NULL) {
		end = strchr(at, '\n');
		if (end)
			*end = '\0';
		if (!*at)
			continue;
		if (order->count == DRAFT_SETTINGS)
			return draft_edit_refuse(report, "too many keys for one edit");
		order->keys[order->count++] = at;
	}
	return 0;
}

static int draft_edit_run(struct rio **rio, const struct edit *edit, struct order *order,
                          struct config_report *report)
{
	int err = split(order, body_string(order->body, "keys"), report);

	if (err)
		return err;
	if (edit->named && !*order->name)
		return draft_edit_refuse(report, "expected \"name\"");
	if (edit->keyed && !order->count)
		return draft_edit_refuse(report, "expected \"keys\": KEY=VALUE, one in each line");
	return edit->run(rio, order, report);
}

static int edit_one(struct rio **rio, const struct body *body, struct config_report *report)
{
	struct order order = {.name = body_string(body, "name"), .body = body};
	const char *what = body_string(body, "do"), *target = body_string(body, "target");
	char *bus = NULL;
	size_t i = 0;
	int err;

	while (i < EDITS && strcmp(edits[i].name, what) != 0)
		i++;
	if (i == EDITS)
		return draft_edit_refuse(report, "expected \"do\": what to do with the text");
	if (edits[i].bus) {
		if (!*target)
			return draft_edit_refuse(report, "expected \"target\"");
		if (asprintf(&bus, EDIT_BUS "%s", target) < 0)
			return -ENOMEM;
		order.name = bus;
	}
	err = draft_edit_run(rio, &edits[i], &order, report);
	free(order.lines);
	free(bus);
	return err;
}

/* Edits in a row, each a JSON object in a line of its own. */
static int edit_steps(struct rio **rio, char *line, struct config_report *report)
{
	int64_t until_ns = ows_now() + STEPS_NS;
	struct body step;
	int err = 0;

	for (char *end; !err && line && *line; line = end) {
		if (ows_now() >= until_ns)
			return draft_edit_refuse(report,
			                         "too many edits at once: choose fewer items");
		end = strchr(line, '\n');
		err = body_parse(line, end ? (size_t)(end - line) : strlen(line), &step);
		if (err)
			return draft_edit_refuse(report, "expected \"steps\": edits as JSON "
			                                 "objects, one in each line");
		err = edit_one(rio, &step, report);
		if (end)
			end++;
	}
	return err;
}

int draft_edit(struct rio **rio, const struct body *body, struct config_report *report)
{
	char *steps;
	int err;

	if (strcmp(body_string(body, "do"), "steps") != 0)
		return edit_one(rio, body, report);
	steps = strdup(body_string(body, "steps"));
	err = steps ? edit_steps(rio, steps, report) : -ENOMEM;
	free(steps);
	return err;
}
