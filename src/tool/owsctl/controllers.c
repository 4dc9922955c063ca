/* SPDX-License-Identifier: MIT */
/* owsctl who: the programs that may command, and which of them commanded each output. */
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>

#include "src/faces/show/actor.h"
#include "src/faces/show/json.h"
#include "src/faces/show/names.h"
#include "src/faces/show/stats.h"
#include "src/faces/show/when.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/table.h"
#include "src/tool/owsctl/verbs.h"

/* clang-format off */
static const struct table_column controller_columns[] = {
	{"PROGRAM"}, {"USER"}, {"SINCE", .right = true}, {"BEAT", .right = true},
	{"COMMANDS", .right = true}, {"REFUSED", .right = true}, {"STATE"},
};
static const struct table_column origin_columns[] = {
	{"OUTPUT"}, {"COMMAND"}, {"BY"}, {"USER"}, {"FOR"}, {"AGO", .right = true},
};
/* clang-format on */
#define COLUMNS(columns) (sizeof(columns) / sizeof((columns)[0]))

struct listing {
	struct ows *h;
	char *const *patterns;
	int count;
	struct when now;
};

static const char *controller_state(const struct ows_controller *controller)
{
	if (controller->late)
		return "late";
	return controller->may_set ? "" : "reads";
}

static void add_controller(struct listing *l, struct table *table,
                           const struct ows_controller *controller)
{
	char program[ACTOR_TEXT], user[ACTOR_TEXT], since[WHEN_TEXT], beat[32], commands[16],
		refused[16];

	snprintf(commands, sizeof(commands), "%" PRIu32, controller->commands);
	snprintf(refused, sizeof(refused), "%" PRIu32, controller->refused);
	if (controller->period_ms)
		snprintf(beat, sizeof(beat), "%gs", controller->period_ms / 1e3);
	else
		snprintf(beat, sizeof(beat), "-");
	table_add(table,
	          (const char *const[]){actor_program(&controller->who, program),
	                                actor_user(&controller->who, user),
	                                when_span(l->now.boot - controller->joined_ns, since), beat,
	                                commands, refused, controller_state(controller)});
}

static void add_origin(struct listing *l, struct table *table, const char *name,
                       const struct ows_origin *origin)
{
	char program[ACTOR_TEXT], user[ACTOR_TEXT], ago[WHEN_TEXT];
	bool none = origin->reason == OWS_REASON_NONE;

	table_add(table, (const char *const[]){
				 name, ows_reason_text(origin->reason),
				 none ? "-" : actor_program(&origin->who, program),
				 none ? "-" : actor_user(&origin->who, user), origin->who.person,
				 none ? "-" : when_span(l->now.boot - origin->taken_ns, ago)});
}

/* The next output that the patterns select, from *signal on, with the origin of its command. */
static bool next_output(struct listing *l, int *signal, struct ows_info *info,
                        struct ows_origin *origin)
{
	for (; ows_info(l->h, *signal, info) == 0; (*signal)++) {
		bool shown = names_match(info->name, l->patterns, l->count);

		if (!shown || ows_origin(l->h, ows_find(l->h, info->name), origin))
			continue;
		if (info->output || origin->reason != OWS_REASON_NONE) {
			(*signal)++;
			return true;
		}
	}
	return false;
}

static void print_text(struct listing *l)
{
	struct table controllers, outputs;
	struct ows_origin origin;
	struct ows_controller controller;
	struct ows_info info;
	int signal = 0;

	table_init(&controllers, controller_columns, COLUMNS(controller_columns));
	table_init(&outputs, origin_columns, COLUMNS(origin_columns));
	for (int i = 0; ows_controller(l->h, i, &controller) == 0; i++)
		if (controller.who.serial)
			add_controller(l, &controllers, &controller);
	while (next_output(l, &signal, &info, &origin))
		add_origin(l, &outputs, info.name, &origin);
	table_print(&controllers, true);
	putchar('\n');
	table_print(&outputs, true);
	table_free(&controllers);
	table_free(&outputs);
}

static void controller_json(const struct listing *l, struct json *json,
                            const struct ows_controller *controller)
{
	char text[WHEN_TEXT];

	json_object(json, NULL);
	actor_json(json, &controller->who);
	json_string(json, "since", when_iso(&l->now, controller->joined_ns, text));
	if (controller->period_ms)
		json_seconds(json, "beat", controller->period_ms * INT64_C(1000000));
	else
		json_null(json, "beat");
	json_bool(json, "may_set", controller->may_set);
	json_bool(json, "late", controller->late);
	json_uint(json, "commands", controller->commands);
	json_uint(json, "refused", controller->refused);
	json_object_end(json);
}

static void origin_json(const struct listing *l, struct json *json, const char *name,
                        const struct ows_origin *origin)
{
	char text[WHEN_TEXT];
	bool none = origin->reason == OWS_REASON_NONE;

	json_object(json, NULL);
	json_string(json, "name", name);
	json_string(json, "reason", none ? NULL : ows_reason_text(origin->reason));
	json_string(json, "time", none ? NULL : when_iso(&l->now, origin->taken_ns, text));
	actor_json(json, &origin->who);
	json_object_end(json);
}

static void controllers_print_json(struct listing *l, const char *instance)
{
	struct ows_origin origin;
	struct ows_controller controller;
	struct ows_info info;
	struct json json;
	int signal = 0;

	json_open(&json, stdout);
	json_object(&json, NULL);
	stats_whose(&json, instance);
	json_array(&json, "controllers");
	for (int i = 0; ows_controller(l->h, i, &controller) == 0; i++)
		if (controller.who.serial)
			controller_json(l, &json, &controller);
	json_array_end(&json);
	json_array(&json, "outputs");
	while (next_output(l, &signal, &info, &origin))
		origin_json(l, &json, info.name, &origin);
	json_array_end(&json);
	json_object_end(&json);
	json_end(&json);
}

int verb_who(struct ctl *ctl, int argc, char **argv)
{
	struct listing l = {0};

	ctl_option(ctl, argc, argv, "");
	l.patterns = argv + optind;
	l.count = argc - optind;
	l.h = ctl_open(ctl, OWS_READ);
	l.now = when_now();
	ctl_alive(ctl, l.h, l.now.boot);
	if (ctl->json)
		controllers_print_json(&l, ctl->instance);
	else
		print_text(&l);
	ows_close(l.h);
	return CTL_DONE;
}
