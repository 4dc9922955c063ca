/* SPDX-License-Identifier: MIT */
/*
 * owsctl enable and disable: switches a program beside owsd on and off, and keeps its user in the
 * groups that its block of the configuration asks for.
 */
#include <errno.h>
#include <getopt.h>
#include <glob.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "src/config/read/load.h"
#include "src/config/read/report.h"
#include "src/memory/shm/segment.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/machine/command.h"
#include "src/tool/owsctl/machine/faces.h"
#include "src/tool/owsctl/machine/seen.h"
#include "src/tool/owsctl/running.h"
#include "src/tool/owsctl/verbs.h"

struct change {
	const struct ctl *ctl;
	const struct face_row *rows;
	int count;
	const struct face_row *row;
	char file[INSTANCE_FIELD];
	struct config *config; /* of the instance; NULL: the program is switched off */
	bool dry;
	int err; /* of the first command that failed: no other is run after it */
	char socket[FACE_UNIT], service[FACE_UNIT];
};

/* A command of at most five words. */
static void run(struct change *change, const char *a, const char *b, const char *c, const char *d,
                const char *e)
{
	const char *const words[] = {a, b, c, d, e, NULL};

	if (!change->err)
		change->err = command_run(words, change->dry);
}

/* The groups that its keys ask for, and who does for it what it may not do itself. */
static void give_rights(struct change *change)
{
	const char *program = change->row->program;
	char unit[FACE_UNIT];

	for (unsigned i = 0; i < FACE_RIGHTS; i++) {
		const struct face_right *right = &face_rights[i];

		if (!face_has(change->config, program, right->key))
			continue;
		run(change, "usermod", "-aG", right->group, program, NULL);
		if (!right->helper)
			continue;
		snprintf(unit, sizeof(unit), "%s@%.200s.socket", right->helper,
		         change->ctl->instance);
		run(change, "systemctl", "enable", "--now", unit, NULL);
	}
}

/* Does the file of another instance ask for it? One that cannot be read may. */
static bool others_ask(const struct change *change, const char *key)
{
	bool asked = false;
	glob_t found = {0};

	glob(CONFIG_DIR "/*.rio", 0, NULL, &found);
	for (size_t i = 0; i < found.gl_pathc && !asked; i++) {
		struct config_report report = {0};
		struct config *config = NULL;

		if (!strcmp(found.gl_pathv[i], change->file))
			continue;
		asked = config_load(found.gl_pathv[i], &report, &config) ||
		        face_has(config, change->row->program, key);
		config_free(config);
	}
	globfree(&found);
	return asked;
}

/* The groups of the keys that are off in all instances: the user is the same. */
static void take_rights(struct change *change)
{
	const char *program = change->row->program;

	for (unsigned i = 0; i < FACE_RIGHTS; i++) {
		const struct face_right *right = &face_rights[i];

		if (face_may(program, right->key) && seen_in_group("", program, right->group) &&
		    !(change->config && face_has(change->config, program, right->key)) &&
		    !others_ask(change, right->key))
			run(change, "gpasswd", "-d", program, right->group, NULL);
	}
}

/* Is there a program of the instance that is switched on, and has the key? */
static bool one_asks(const struct change *change, const struct config *config, const char *key)
{
	char unit[FACE_UNIT];

	for (int i = 0; i < change->count; i++) {
		const struct face_row *row = &change->rows[i];

		face_unit(row, change->ctl->instance, row->socket ? "socket" : "service", unit);
		if ((row == change->row ? change->config != NULL : face_starts("", unit)) &&
		    face_has(config, row->program, key))
			return true;
	}
	return false;
}

/* Does a program ask the helper, or may a person of the group? */
static bool helper_is_asked(const struct change *change, const struct config *config,
                            const char *helper)
{
	bool asked = false;

	for (unsigned i = 0; i < FACE_RIGHTS; i++) {
		const struct face_right *right = &face_rights[i];

		if (right->helper && !strcmp(right->helper, helper))
			asked |= seen_in_group("", NULL, right->group) ||
			         one_asks(change, config, right->key);
	}
	return asked;
}

/* It goes with the last program that asks it. By a file with errors one may. */
static void take_helper(struct change *change, const char *helper)
{
	struct config_report report = {0};
	struct config *config = NULL;
	char unit[FACE_UNIT];

	snprintf(unit, sizeof(unit), "%s@%.200s.socket", helper, change->ctl->instance);
	if (face_starts("", unit) && !config_load(change->file, &report, &config) &&
	    !helper_is_asked(change, config, helper))
		run(change, "systemctl", "disable", "--now", unit, NULL);
	config_free(config);
}

/* Of the helpers that the program may ask. */
static void take_helpers(struct change *change)
{
	const char *taken = "";

	for (unsigned i = 0; i < FACE_RIGHTS; i++) {
		const struct face_right *right = &face_rights[i];

		if (!right->helper || !strcmp(right->helper, taken) ||
		    !face_may(change->row->program, right->key))
			continue;
		take_helper(change, right->helper);
		taken = right->helper;
	}
}

static void switch_on(struct change *change)
{
	/* systemd knows no address of the file, so the program itself has to run for them */
	bool serves = !change->row->socket ||
	              face_has(change->config, change->row->program, "Listen");

	give_rights(change);
	take_rights(change);
	take_helpers(change);
	if (change->row->socket)
		run(change, "systemctl", "enable", "--now", change->socket, NULL);
	if (serves)
		run(change, "systemctl", "enable", change->service, NULL, NULL);
	/* a process has the groups of its start */
	run(change, "systemctl", serves ? "restart" : "try-restart", change->service, NULL, NULL);
}

static void say_where(const struct change *change)
{
	const char *program = change->row->program, *instance = change->ctl->instance;
	char addresses[400];

	if (!change->config->item_count)
		printf("%s has no signals, so there is nothing to show: owsctl doctor\n",
		       change->config->file);
	if (face_may(program, NULL) && !face_has_block(change->config, program))
		printf("%s has no block for %s: %s(8) says what it may have\n",
		       change->config->file, program, program);
	if (strcmp(program, "owsd-web") != 0)
		return;
	face_addresses(change->config, addresses, sizeof(addresses));
	printf("page: %s%s/run/owsd/%s.web\n", addresses, *addresses ? " " : "", instance);
	if (!*addresses)
		printf("      for a browser without a proxy: Web { Listen \"127.0.0.1:8080\" } in %s, "
		       "and again: sudo owsctl -n %s enable web\n",
		       change->config->file, instance);
}

static int no_face(const struct ctl *ctl, const char *word, const struct face_row *rows, int count)
{
	char names[256] = "";
	size_t used = 0;

	for (int i = 0; i < count && used < sizeof(names); i++)
		used += (size_t)snprintf(names + used, sizeof(names) - used, " %s",
		                         rows[i].program + strlen("owsd-"));
	return ctl_usage(ctl, "there is no %s; there are:%s", ctl_word(word), names);
}

static int change_faces(struct ctl *ctl, int argc, char **argv, bool on)
{
	static struct face_row rows[FACE_ROWS];
	struct config_report report = {.line = ctl_report};
	struct change change = {.ctl = ctl};
	int count = faces_table(rows);

	while (ctl_option(ctl, argc, argv, "D") != -1)
		change.dry = true;
	if (count < 0)
		return ctl_fail("the table of the programs beside owsd: %s", strerror(-count));
	if (optind != argc - 1)
		return ctl_usage(ctl, "%s which one?", ctl->verb->name);
	change.rows = rows;
	change.count = count;
	change.row = faces_find(rows, count, argv[optind]);
	if (!change.row)
		return no_face(ctl, argv[optind], rows, count);
	if (!segment_name_ok(ctl->instance))
		return ctl_fail("%s cannot be the name of an instance", ctl_word(ctl->instance));
	face_unit(change.row, ctl->instance, "socket", change.socket);
	face_unit(change.row, ctl->instance, "service", change.service);
	if (!change.dry && geteuid() != 0)
		return ctl_fail("that is for root: sudo owsctl -n %s %s %s", ctl->instance,
		                ctl->verb->name, argv[optind]);
	if (!change.dry && !face_is_installed("", change.row))
		return ctl_fail("%s is not installed: sudo apt install %s", change.row->program,
		                change.row->package);
	instance_config(ctl->instance, change.file);
	if (!on) {
		run(&change, "systemctl", "disable", "--now", change.service,
		    change.row->socket ? change.socket : NULL);
		take_rights(&change);
		take_helpers(&change);
		return change.err ? CTL_FAILED : CTL_DONE;
	}
	/* a program does not start with a file that it refuses; the reason is printed */
	if (config_load(change.file, &report, &change.config))
		return CTL_FAILED;
	switch_on(&change);
	if (!change.err)
		say_where(&change);
	config_free(change.config);
	return change.err ? CTL_FAILED : CTL_DONE;
}

int verb_enable(struct ctl *ctl, int argc, char **argv)
{
	return change_faces(ctl, argc, argv, true);
}

int verb_disable(struct ctl *ctl, int argc, char **argv)
{
	return change_faces(ctl, argc, argv, false);
}
