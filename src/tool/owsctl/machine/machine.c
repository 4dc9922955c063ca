/* SPDX-License-Identifier: MIT */
/* owsctl doctor: the disk, the configuration, the board, rights and groups, the clock. */
#include <errno.h>
#include <glob.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/rivals.h"
#include "hal/bus/backends.h"
#include "hal/bus/bus.h"
#include "hal/serial/find.h"
#include "src/config/check/check.h"
#include "src/config/read/load.h"
#include "src/config/read/report.h"
#include "src/tool/owsctl/machine/faces.h"
#include "src/tool/owsctl/machine/machine.h"
#include "src/tool/owsctl/machine/seen.h"
#include "src/tool/owsctl/machine/units.h"

#define ROOM_KB 1024 /* the image of 2 000 signals, or some minutes of history */
#define SHOWN 3      /* of the errors of a file, and of the warnings */
#define SCAN_BEGIN "sudo systemctl stop owsd@%s; owsctl -t auto scan --rio "
#define SCAN_END ">new.rio && sudo cp new.rio %s; sudo systemctl start owsd@%s"

void check_disk(struct doctor *d)
{
	static const char *const words[] = {"df", "-Pk", "/run", "/etc", "/var", NULL};
	char last[64] = "", *rest = d->text, *line;

	if (!seen_output(d, "df", words))
		return;
	(void)strsep(&rest, "\n"); /* the heads */
	while ((line = strsep(&rest, "\n"))) {
		unsigned long long room;
		char at[64];

		/* NOLINTNEXTLINE(cert-err34-c): a number that is too great is no small one */
		if (sscanf(line, "%*s %*s %*s %llu %*s %63s", &room, at) != 2 || !strcmp(at, last))
			continue;
		snprintf(last, sizeof(last), "%s", at);
		if (room >= ROOM_KB)
			continue;
		report_add(&d->found, BOARD_MISSING, "%s is full: %llu kB are free", at, room);
		report_command(&d->found, "make room on %s: sudo du -xah %s | sort -h | tail -20",
		               at, at);
	}
}

/* --- The configuration ----------------------------------------------------------------------- */

struct told {
	struct doctor *d;
	struct config_report report;
	unsigned shown[2];
};

static void take_message(void *ctx, bool is_error, const char *message)
{
	struct told *told = ctx;
	struct doctor *d = told->d;

	if (told->shown[is_error]++ >= SHOWN)
		return;
	report_add(&d->found, is_error ? BOARD_MISSING : BOARD_NOTE, "%s", message);
	if (is_error && told->report.at_line > 0 && told->report.at_line < 1 << 30)
		report_remedy(&d->found, "correct line %d of %s, then: sudo owsctl -n %s reload",
		              told->report.at_line, d->file, d->instance);
	else if (is_error)
		report_remedy(&d->found, "correct %s, then: sudo owsctl -n %s reload", d->file,
		              d->instance);
}

/*
 * The way of docs/bring-up.md: the service has the chip, so it is stopped for the scan. What stands
 * in a file, such as blocks for programs, stays.
 */
static void advise_scan(struct doctor *d, bool there)
{
	if (there)
		report_command(&d->found, SCAN_BEGIN "--merge %s " SCAN_END, d->instance, d->file,
		               d->file, d->instance);
	else
		report_command(&d->found, SCAN_BEGIN SCAN_END, d->instance, d->file, d->instance);
}

void check_configuration(struct doctor *d)
{
	struct told told = {.d = d, .report = {.line = take_message, .ctx = &told}};

	if (access(d->file, F_OK) && errno == ENOENT) {
		/* an owsd that somebody runs by hand may need none */
		if (!units_owsd(d))
			return;
		report_add(&d->found, BOARD_MISSING, "there is no %s", d->file);
		advise_scan(d, false);
		return;
	}
	if (config_load(d->file, &told.report, &d->config) == 0)
		config_check(d->config, &told.report);
	d->errors = told.report.errors;
	if (!d->config || d->errors || d->config->item_count)
		return;
	report_add(&d->found, BOARD_MISSING, "%s has no signals", d->file);
	advise_scan(d, true);
}

/* --- The board ------------------------------------------------------------------------------- */

static bool needs_board(const char *target)
{
	const char *where;
	const struct bus_ops *ops = bus_backend(target, &where);

	return ops && ops->board_advice;
}

static bool needs_master(const char *target)
{
	const char *where;

	return bus_backend(target, &where) == bus_backend("w1", &where);
}

/* Has a wire no way that is up, and one of its ways is such a target? */
static bool lacks(const struct doctor *d, bool (*needs)(const char *target))
{
	struct ows_target target, other;

	for (int i = 0; d->alive && ows_target(d->ows, i, &target) == 0; i++) {
		bool up = false;

		for (int k = 0; ows_target(d->ows, k, &other) == 0; k++)
			up |= other.group == target.group && other.state == 1;
		if (!up && needs(target.name))
			return true;
	}
	for (unsigned i = 0; !d->alive && d->config && i < d->config->target_count; i++)
		if (needs(d->config->targets[i].text))
			return true;
	/* a machine on which nothing was set up is to have a DS2482 */
	return d->err == -ENOENT && !d->config && needs == needs_board;
}

static bool is_of_person(const struct board_line *line)
{
	return strncmp(line->remedy, "sudo adduser ", 13) == 0;
}

/* The serial ports that stay what they are, and who has one. */
static void report_serial(struct doctor *d)
{
	char pattern[DOCTOR_ROOT + 40], proc[DOCTOR_ROOT + 8], who[RIVALS_TEXT];
	glob_t found;

	snprintf(proc, sizeof(proc), "%s" RIVALS_PROC, d->root);
	snprintf(pattern, sizeof(pattern), "%s" SERIAL_BY_ID "/*", d->root);
	if (glob(pattern, 0, NULL, &found) == 0)
		for (size_t i = 0; i < found.gl_pathc; i++) {
			rivals_find(proc, found.gl_pathv[i], who, sizeof(who));
			report_add(&d->found, BOARD_FACT, "serial port: %s%s%s",
			           found.gl_pathv[i] + strlen(d->root), *who ? ", open in " : "",
			           who);
		}
	globfree(&found);
}

void check_board(struct doctor *d)
{
	bool needed = lacks(d, needs_board), used = needed;
	struct ows_target target;

	for (int i = 0; d->alive && ows_target(d->ows, i, &target) == 0; i++)
		used |= needs_board(target.name) && target.state == 1;
	for (unsigned i = 0; i < d->board.count; i++) {
		const struct board_line *line = &d->board.line[i];
		enum board_kind kind = BOARD_NOTE;

		/* what this person may not do the service may */
		if (line->kind != BOARD_FACT &&
		    (!used || (line->kind == BOARD_MISSING &&
		               (!needed || (d->alive && is_of_person(line))))))
			continue;
		if (line->kind == BOARD_MISSING || line->kind == BOARD_RIVAL)
			kind = BOARD_MISSING;
		else if (line->kind == BOARD_FACT || !*line->remedy)
			kind = BOARD_FACT;
		report_add(&d->found, kind, "%s", line->text);
		/* what this board is not known for it says in the text */
		report_remedy(&d->found, "%s",
		              kind == BOARD_MISSING && !*line->remedy ? line->text : line->remedy);
	}
	report_serial(d);
	if (*d->board.master && lacks(d, needs_master)) {
		report_add(&d->found, needed ? BOARD_NOTE : BOARD_MISSING,
		           "the kernel has no 1-Wire master, as for a sensor at a GPIO pin");
		report_remedy(&d->found, "%s", d->board.master);
	}
}

/* --- Rights ---------------------------------------------------------------------------------- */

/* A file of sysusers.d says which user is a member of which group. Is one not? */
static bool take_sysusers(struct doctor *d, const char *path)
{
	char line[200], kind[4], user[64], group[64];
	FILE *in = fopen(path, "re");
	bool missing = false;

	while (in && !missing && fgets(line, sizeof(line), in))
		missing = sscanf(line, "%3s %63s %63s", kind, user, group) == 3 &&
		          !strcmp(kind, "m") && !seen_in_group(d->root, user, group);
	if (in)
		fclose(in);
	if (!missing)
		return false;
	report_add(&d->found, BOARD_MISSING, "the user %s is not in the group %s", user, group);
	report_remedy(&d->found, "sudo systemd-sysusers    # then: sudo systemctl restart '%s@*'",
	              user);
	return true;
}

static void check_service_users(struct doctor *d)
{
	glob_t found;
	size_t n = faces_files(d->root, "sysusers.d/owsd*.conf", &found);

	/* one command makes all of them */
	for (size_t i = 0; i < n && !take_sysusers(d, found.gl_pathv[i]); i++)
		;
	globfree(&found);
}

/* May this person look at the signals? */
static void check_person(struct doctor *d)
{
	const struct passwd *user = *d->root || d->err != -EACCES ? NULL : getpwuid(geteuid());
	bool member = user && seen_in_group(d->root, user->pw_name, "owsd");

	if (!user)
		return;
	report_add(&d->found, BOARD_MISSING, "%s may not look at the signals%s", user->pw_name,
	           member ? ": this login is older than the group" : "");
	report_command(&d->found,
	               member ? "log in again, as %s"
	                      : "sudo adduser %s owsd    # then log in again",
	               user->pw_name);
}

void check_rights(struct doctor *d)
{
	char path[512];

	check_service_users(d);
	snprintf(path, sizeof(path), "%s/run/owsd", d->root);
	if (d->units && access(path, F_OK)) {
		report_add(&d->found, BOARD_MISSING,
		           "there is no /run/owsd, where owsd has its files");
		report_remedy(&d->found, "sudo systemd-tmpfiles --create");
	}
	check_person(d);
}

/* --- The clock ------------------------------------------------------------------------------- */

void check_clock(struct doctor *d)
{
	static const char *const words[] = {"timedatectl", "show", NULL};

	if (!seen_output(d, "timedatectl", words) || !strstr(d->text, "NTPSynchronized=no"))
		return;
	report_add(&d->found, BOARD_NOTE,
	           "nobody sets the clock: history has the time of this machine");
	/* somebody may have switched it off, or there is nobody who would */
	report_remedy(&d->found, strstr(d->text, "CanNTP=no") ? "sudo apt install systemd-timesyncd"
	                         : strstr(d->text, "\nNTP=no") ? "sudo timedatectl set-ntp true"
	                                                       : "timedatectl timesync-status");
}
