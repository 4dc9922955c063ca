/* SPDX-License-Identifier: MIT */
/* owsctl doctor: what is wrong on this machine, in the order in which to mend it, and with what. */
#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/config/read/load.h"
#include "src/faces/show/json.h"
#include "src/ground/board/look.h"
#include "src/memory/shm/segment.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/machine/command.h"
#include "src/tool/owsctl/machine/doctor.h"
#include "src/tool/owsctl/machine/machine.h"
#include "src/tool/owsctl/machine/seen.h"
#include "src/tool/owsctl/machine/services.h"
#include "src/tool/owsctl/machine/units.h"
#include "src/tool/owsctl/machine/wire.h"
#include "src/tool/owsctl/verbs.h"

/* A cause stands before what follows from it. */
static const struct {
	const char *name;
	void (*look)(struct doctor *d);
} checks[] = {
	{"disk", check_disk},       {"configuration", check_configuration},
	{"board", check_board},     {"rights", check_rights},
	{"signals", check_signals}, {"services", check_services},
	{"owsd", check_owsd},       {"targets", check_targets},
	{"wire", check_wire},       {"faces", check_faces},
	{"clock", check_clock},
};

/*
 * Remedies that change nothing of a plant, and nothing that somebody has decided; behind '-' stands
 * the rest of one unit's name. Words of programs never fit: SEEN_SAYS stands before them.
 */
static const char *const safe[] = {
	"sudo modprobe i2c-dev",          "sudo systemd-sysusers",
	"sudo systemd-tmpfiles --create", "sudo systemctl start owsd-",
	"sudo systemctl restart owsd-",   "sudo systemctl reload owsd-",
};

/* Of the command in it, without what is said to it. */
static size_t remedy_length(const char *remedy)
{
	const char *end = strstr(remedy, "    #");

	return end ? (size_t)(end - remedy) : strlen(remedy);
}

bool doctor_is_safe(const char *remedy)
{
	static const char unit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
				   "0123456789-_.@";
	size_t whole = remedy_length(remedy);

	for (size_t i = 0; i < sizeof(safe) / sizeof(safe[0]); i++) {
		size_t len = strlen(safe[i]), rest;

		if (strncmp(remedy, safe[i], len) != 0)
			continue;
		rest = strspn(remedy + len, unit);
		if (safe[i][len - 1] == '-' ? rest && len + rest == whole : len == whole)
			return true;
	}
	return false;
}

bool doctor_look(struct doctor *d)
{
	struct ows_daemon daemon = {0};
	char folder[400], why[800];

	d->found = (struct board_report){0};
	d->errors = 0;
	d->now_ns = ows_now();
	d->faces = faces_table(d->face);
	units_load(d);
	/* of another machine it is that of the service */
	if (*d->root)
		snprintf(d->file, sizeof(d->file), "%s" CONFIG_DIR "/%s.rio", d->root, d->instance);
	else
		instance_config(d->instance, d->file);
	d->ows = NULL;
	d->err = ows_open_as(d->instance, OWS_READ, "owsctl doctor", &d->ows);
	if (!d->err)
		ows_daemon(d->ows, d->now_ns, &daemon);
	d->alive = daemon.alive;
	board_folder(folder, sizeof(folder));
	board_look(d->root, folder, NULL, &d->board, why, sizeof(why));
	for (size_t i = 0; i < sizeof(checks) / sizeof(checks[0]); i++) {
		unsigned before = d->found.count;

		checks[i].look(d);
		for (unsigned k = before; k < d->found.count; k++)
			d->check[k] = checks[i].name;
	}
	if (d->ows)
		ows_close(d->ows);
	config_free(d->config);
	d->config = NULL;
	return d->found.missing;
}

/* What is to be done stands first; the order of the checks is that in which to do it. */
static const struct {
	enum board_kind kind;
	const char *name, *begin;
} kinds[] = {
	{BOARD_MISSING, "todo", "   "}, {BOARD_NOTE, "note", "note: "}, {BOARD_FACT, "fact", ""}};
#define KINDS (sizeof(kinds) / sizeof(kinds[0]))

static void print_text(const struct board_line *line, unsigned kind, unsigned *number)
{
	bool todo = kinds[kind].kind == BOARD_MISSING;

	if (todo)
		printf("%u. %s\n", ++*number, *line->remedy ? line->remedy : line->text);
	/* a remedy may say it all */
	if (!todo || (*line->remedy && strcmp(line->text, line->remedy) != 0))
		printf("%s%s\n", kinds[kind].begin, line->text);
	if (!todo && *line->remedy)
		printf("    %s\n", line->remedy);
}

static void print_json(struct json *json, const struct board_line *line, unsigned kind,
                       const char *check)
{
	json_object(json, NULL);
	json_string(json, "kind", kinds[kind].name);
	json_string(json, "check", check);
	json_string(json, "text", line->text);
	json_string(json, "remedy", *line->remedy ? line->remedy : NULL);
	json_bool(json, "safe", doctor_is_safe(line->remedy));
	json_object_end(json);
}

static void print(const struct doctor *d, bool as_json)
{
	unsigned number = 0;
	struct json json;

	json_list(&json, stdout, as_json);
	if (!as_json && !d->found.missing)
		puts("nothing is to be done");
	for (unsigned kind = 0; kind < KINDS; kind++)
		for (unsigned i = 0; i < d->found.count; i++) {
			const struct board_line *line = &d->found.line[i];

			if (line->kind != kinds[kind].kind)
				continue;
			if (as_json)
				print_json(&json, line, kind, d->check[i]);
			else
				print_text(line, kind, &number);
		}
	json_list_end(&json);
}

/* Run each remedy that is safe, as the report has it, but for sudo: this is root. */
static bool fix(const struct doctor *d)
{
	bool ran = false;

	for (unsigned i = 0; i < d->found.count; i++) {
		const char *remedy = d->found.line[i].remedy;

		if (!doctor_is_safe(remedy))
			continue;
		ran = true;
		command_line(remedy + strlen("sudo "), remedy_length(remedy) - strlen("sudo "));
	}
	return ran;
}

/* A recorded machine has its files of run/owsd there. */
static const char *take_root(const char *given)
{
	static char root[DOCTOR_ROOT + 1];
	char dir[sizeof(root) + 16], whole[PATH_MAX];
	int err = realpath(given, whole) ? 0 : errno;

	if (err || strlen(whole) > DOCTOR_ROOT)
		ctl_end(ctl_fail("--root %s: %s", ctl_word(given),
		                 strerror(err ? err : ENAMETOOLONG)));
	snprintf(root, sizeof(root), "%.*s", DOCTOR_ROOT, whole);
	snprintf(dir, sizeof(dir), "%s/run/owsd", root);
	setenv("OWS_DIR", dir, 0);
	return root;
}

int verb_doctor(struct ctl *ctl, int argc, char **argv)
{
	static struct doctor d;
	bool fixes = false, ran = false;
	int c;

	d.root = "";
	while ((c = ctl_option(ctl, argc, argv, "FO:")) != -1)
		if (c == 'F')
			fixes = true;
		else
			d.root = take_root(optarg);
	if (optind < argc)
		return ctl_usage(ctl, "doctor takes no operands");
	if (fixes && *d.root)
		return ctl_usage(ctl, "--fix is for this machine, and --root names another");
	if (!segment_name_ok(ctl->instance))
		return ctl_fail("%s cannot be the name of an instance", ctl_word(ctl->instance));
	if (fixes && geteuid() != 0)
		return ctl_fail("--fix is for root: sudo owsctl -n %s doctor --fix", ctl->instance);
	d.instance = ctl->instance;
	doctor_look(&d);
	if (fixes) {
		ran = fix(&d);
		doctor_look(&d);
	}
	if (fixes && !ran && d.found.missing)
		ctl_tell("--fix runs none of these: each may change a plant, or what somebody has "
		         "decided");
	print(&d, ctl->json);
	return d.found.missing ? CTL_FAILED : CTL_DONE;
}
