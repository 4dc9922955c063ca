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
#include "hal/usb/find.h"
#include "src/config/check/check.h"
#include "src/config/read/load.h"
#include "src/config/read/report.h"
#include "src/tool/owsctl/machine/faces.h"
#include "src/tool/owsctl/machine/machine.h"
#include "src/tool/owsctl/machine/seen.h"
#include "src/tool/owsctl/machine/units.h"

#define ROOM_KB 1024 /* the image of 2 000 signals, or some minutes of history */
#define SHOWN 3      /* of the errors of a file, and of the warnings */
#define SCAN_BEGIN "sudo systemctl stop owsd@%s; owsctl -t %s scan --rio --bits "
#define SCAN_END ">new.rio && sudo cp new.rio %s; sudo systemctl start owsd@%s"
#define PORT_TEXT 200
#define OWSERVER "localhost:4304" /* a way of auto */
#define OWSERVER_OFF "sudo systemctl disable --now owserver.socket owserver.service"

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
		/* what cannot be written is full by nature, as a squashfs */
		if (room >= ROOM_KB || (!*d->root && access(at, W_OK) && errno == EROFS))
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
	char load[UNITS_COMMAND];

	if (told->shown[is_error]++ >= SHOWN)
		return;
	report_add(&d->found, is_error ? BOARD_MISSING : BOARD_NOTE, "%s", message);
	if (is_error && told->report.at_line > 0 && told->report.at_line < 1 << 30)
		report_remedy(&d->found, "correct line %d of %s, then: %s", told->report.at_line,
		              d->file, units_load_command(d, load));
	else if (is_error)
		report_remedy(&d->found, "correct %s, then: %s", d->file,
		              units_load_command(d, load));
}

void check_configuration(struct doctor *d)
{
	struct told told = {.d = d, .report = {.line = take_message, .ctx = &told}};
	int err = access(d->file, R_OK) ? errno : 0;

	if (err == ENOENT)
		return;
	/* the file has no fault by that */
	if (err == EACCES) {
		report_add(&d->found, BOARD_NOTE, "this user may not read %s", d->file);
		report_command(&d->found, "sudo owsctl -n %s doctor", d->instance);
		return;
	}
	if (config_load(d->file, &told.report, &d->config) == 0)
		config_check(d->config, &told.report);
	d->errors = told.report.errors;
}

/* --- The board ------------------------------------------------------------------------------- */

static bool needs_board(const char *target)
{
	const struct bus_ops *ops = bus_backend(target, NULL);

	return ops && ops->board_advice;
}

static bool needs_master(const char *target)
{
	return bus_backend(target, NULL) == bus_backend("w1", NULL);
}

static bool needs_port(const char *target)
{
	const struct bus_ops *ops = bus_backend(target, NULL);

	return ops == bus_backend("serial", NULL) || ops == bus_backend("uart", NULL);
}

/* Target n, of owsd or of the configuration: false: there are no more. */
static bool target_at(const struct doctor *d, unsigned n, struct ows_target *target)
{
	*target = (struct ows_target){0};
	if (d->alive)
		return ows_target(d->ows, (int)n, target) == 0;
	if (!d->config || n >= d->config->target_count)
		return false;
	target->name = d->config->targets[n].text;
	return true;
}

/* Has a wire no way that is up, and one of its ways is such a target? */
static bool lacks(const struct doctor *d, bool (*needs)(const char *target))
{
	struct ows_target target, other;

	/* this person may not see how they do */
	if (d->err == -EACCES)
		return false;
	for (unsigned n = 0; target_at(d, n, &target); n++) {
		bool up = false;

		for (int k = 0; d->alive && ows_target(d->ows, k, &other) == 0; k++)
			up |= other.group == target.group && other.state == 1;
		if (!up && needs(target.name))
			return true;
	}
	/* a machine on which nothing was set up is to have a DS2482 */
	return d->err == -ENOENT && !d->config && needs == needs_board;
}

static bool is_of_person(const struct board_line *line)
{
	return strncmp(line->remedy, "sudo adduser ", 13) == 0;
}

/* The one serial port that stays what it is, without the root; "": there is none, or several. */
static void find_port(const struct doctor *d, char port[PORT_TEXT])
{
	char names[DOCTOR_ROOT + 20], path[DOCTOR_ROOT + PORT_TEXT];

	snprintf(names, sizeof(names), "%s" SERIAL_NAMES, d->root);
	if (tty_only(names, path, sizeof(path)))
		snprintf(port, PORT_TEXT, "%s", path + strlen(d->root));
	else
		*port = '\0';
}

/* Which other program has the serial port of a target, or may have it? */
static void check_port(struct doctor *d, const char *target)
{
	char proc[DOCTOR_ROOT + 8], device[DOCTOR_ROOT + PORT_TEXT], who[RIVALS_TEXT];
	char only[PORT_TEXT];
	const char *where;

	bus_backend(target, &where);
	find_port(d, only);
	where = *where ? where : only;
	snprintf(proc, sizeof(proc), "%s" RIVALS_PROC, d->root);
	snprintf(device, sizeof(device), "%s%s", d->root, where);
	if (*where && rivals_find(proc, device, who, sizeof(who))) {
		report_add(&d->found, BOARD_MISSING,
		           "%s is open in %s: two programs on one adapter disturb each other",
		           where, who);
		if (strstr(who, "owserver, "))
			report_remedy(&d->found, OWSERVER_OFF);
		else
			report_remedy(&d->found,
			              "end that process, or have it take another adapter");
	} else if ((d->err == -EACCES || lacks(d, needs_port)) &&
	           rivals_hidden(proc, who, sizeof(who))) {
		report_add(&d->found, BOARD_MISSING, "%s runs, and may have the port of target %s",
		           who, target);
		report_remedy(&d->found, OWSERVER_OFF "    # sudo owsctl doctor sees if it has");
	}
}

/* The DS9490R that are plugged in: how many. */
static unsigned find_adapters(const struct doctor *d, struct usb_place places[USB_PLACES])
{
	char devices[DOCTOR_ROOT + 24];

	snprintf(devices, sizeof(devices), "%s/sys/bus/usb/devices", d->root);
	return usb_find(devices, places);
}

/* Has a driver of the kernel the first of them? usbfs is a program. */
static bool kernel_has_adapter(const struct doctor *d, char driver[USB_NAME])
{
	struct usb_place places[USB_PLACES];

	if (!find_adapters(d, places) || !*places[0].driver || !strcmp(places[0].driver, "usbfs"))
		return false;
	snprintf(driver, USB_NAME, "%s", places[0].driver);
	return true;
}

/*
 * The target of an adapter that auto does not open: a DS9490R that no driver has, else the one
 * serial port, of which nobody but a person knows what is at it. "": there is none.
 */
static void left_by_auto(const struct doctor *d, char target[PORT_TEXT + 8])
{
	char port[PORT_TEXT];
	struct usb_place places[USB_PLACES];

	find_port(d, port);
	if (find_adapters(d, places) && !*places[0].driver)
		snprintf(target, PORT_TEXT + 8, "usb:");
	else
		snprintf(target, PORT_TEXT + 8, "%s%s", *port ? "serial:" : "", port);
}

static void advise_adapter(struct doctor *d, const char *target)
{
	char load[UNITS_COMMAND];
	const char *port;

	bus_backend(target, &port);
	report_add(&d->found, BOARD_MISSING,
	           *port ? "%s is plugged in, and auto opens no serial port: it may be a modem's"
	                 : "%sa DS9490R is plugged in, and auto opens no USB adapter",
	           port);
	report_remedy(&d->found, "write TargetName \"%s\" into %s, then: %s", target, d->file,
	              units_load_command(d, load));
}

void check_board(struct doctor *d)
{
	bool needed = lacks(d, needs_board), used = false;
	struct ows_target target;
	char left[PORT_TEXT + 8];

	for (unsigned n = 0; target_at(d, n, &target); n++) {
		used |= needs_board(target.name) && target.state == 1;
		if (needs_port(target.name))
			check_port(d, target.name);
	}
	left_by_auto(d, left);
	if (needed && seen_automatic(d)) {
		/* an owserver is a way, too: one that does not run is reported as a target */
		needed = d->alive ? !seen_owserver_stopped(d, OWSERVER) : !seen_owserver(d->root);
		if (needed && *left && d->config)
			advise_adapter(d, left);
		needed = needed && !*left;
	}
	used |= needed;
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

/* --- Signals --------------------------------------------------------------------------------- */

/* That of the file, else what is there. driver: the kernel's that has the adapter, or "". */
static const char *scan_target(const struct doctor *d, char text[PORT_TEXT + 8],
                               char driver[USB_NAME])
{
	*driver = '\0';
	if (d->config && d->config->target_count && !seen_automatic(d))
		return d->config->targets[0].text;
	if (!seen_owserver(d->root) && kernel_has_adapter(d, driver))
		return "w1";
	left_by_auto(d, text);
	if (!*text || seen_owserver(d->root) || (strcmp(text, "usb:") != 0 && !d->board.missing))
		snprintf(text, PORT_TEXT + 8, "auto");
	return text;
}

/*
 * The way of docs/bring-up.md: the service has the chip, so it is stopped for the scan. What stands
 * in a file, such as blocks for programs, stays.
 */
void check_signals(struct doctor *d)
{
	bool there = !access(d->file, F_OK) || errno != ENOENT;
	char target[PORT_TEXT + 8], driver[USB_NAME];
	const char *where;

	/* an owsd that somebody runs by hand may need no file */
	if (there ? !d->config || d->errors || d->config->item_count : !units_owsd(d))
		return;
	where = scan_target(d, target, driver);
	report_add(&d->found, BOARD_MISSING, there ? "%s has no signals" : "there is no %s",
	           d->file);
	if (there)
		report_command(&d->found, SCAN_BEGIN "--merge %s " SCAN_END, d->instance, where,
		               d->file, d->file, d->instance);
	else
		report_command(&d->found, SCAN_BEGIN SCAN_END, d->instance, where, d->file,
		               d->instance);
	if (!*driver)
		return;
	report_add(&d->found, BOARD_NOTE, "the kernel's driver %s has the USB adapter: target w1",
	           driver);
	report_remedy(&d->found, "with usb: in place of w1 owsd takes it from that driver, and "
	                         "gives it back at its end");
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
