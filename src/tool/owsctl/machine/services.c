/* SPDX-License-Identifier: MIT */
/* owsctl doctor: the services, owsd itself, and the programs beside it. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "hal/base/time.h"
#include "src/config/read/config.h"
#include "src/faces/show/faces.h"
#include "src/faces/show/stats.h"
#include "src/faces/show/when.h"
#include "src/ground/service/listen.h"
#include "src/tool/owsctl/machine/seen.h"
#include "src/tool/owsctl/machine/services.h"
#include "src/tool/owsctl/machine/units.h"

/* The last line that the unit's own process has logged; "" where this user may not read it. */
static const char *last_words(struct doctor *d, const struct unit *unit)
{
	char match[FACE_UNIT + 20], name[FACE_UNIT + 10];
	const char *const words[] = {"journalctl", "-q", "-n", "1", "-o", "cat", match, NULL};

	snprintf(match, sizeof(match), "_SYSTEMD_UNIT=%s", unit->id);
	snprintf(name, sizeof(name), "journal-%s", unit->id);
	seen_output(d, name, words);
	d->text[strcspn(d->text, "\n")] = '\0';
	return d->text;
}

static void report_failure(struct doctor *d, const struct unit *unit)
{
	const char *words = last_words(d, unit);

	report_add(&d->found, BOARD_MISSING, "%s fails (%s)", unit->id, unit->sub);
	/* programs say in their last line what is wrong, and what to do */
	if (*words)
		report_remedy(&d->found, SEEN_SAYS, unit->id, words);
	else
		report_command(&d->found, "sudo journalctl -u %s -n 20", unit->id);
}

void check_services(struct doctor *d)
{
	for (unsigned i = 0; i < d->units; i++) {
		const struct unit *unit = &d->unit[i];
		bool own = !strncmp(unit->id, "owsd@", 5);

		if (!strcmp(unit->active, "failed") || !strcmp(unit->sub, "auto-restart")) {
			/* all of them refuse a wrong file, which is reported already */
			if (!d->errors)
				report_failure(d, unit);
		} else if (!strcmp(unit->active, "inactive") && face_starts(d->root, unit->id)) {
			report_add(&d->found, BOARD_MISSING, "%s is enabled, and does not run",
			           unit->id);
			report_command(&d->found, "sudo systemctl start %s", unit->id);
		} else if (own && unit_is_active(unit) && !face_starts(d->root, unit->id)) {
			report_add(&d->found, BOARD_NOTE, "%s does not start with the machine",
			           unit->id);
			report_command(&d->found, "sudo systemctl enable %s", unit->id);
		}
	}
}

/* --- owsd ------------------------------------------------------------------------------------ */

/* What is left in this user's own place of one that ended, beside the living one of the service. */
static void name_left(struct doctor *d, const struct shm_dir *dir)
{
	char ago[WHEN_TEXT];
	struct instance_info info;

	instance_look(dir, d->instance, d->now_ns, &info);
	if (info.state != INSTANCE_STOPPED && info.state != INSTANCE_KILLED)
		return;
	report_add(&d->found, BOARD_NOTE,
	           "%s has values of another owsd %s, which ended %s ago: a program that finds "
	           "them alone sees no living one",
	           dir->path, d->instance, when_span(d->now_ns - info.since_ns, ago));
	report_command(&d->found, "owsctl remove %s", d->instance);
}

/* Two owsd of one name, of two users: each user's programs talk to another one. */
static void check_twins(struct doctor *d)
{
	char paths[DIRS][DIR_PATH];
	int dirs = dir_list(paths), pid[DIRS] = {0};
	unsigned up = 0;

	for (int i = 0; i < dirs; i++) {
		struct shm_dir dir;

		if (dir_open(paths[i], &dir))
			continue;
		if (instance_runs(&dir, d->instance, &pid[i]))
			up++;
		else if (i == 0)
			name_left(d, &dir);
		dir_close(&dir);
	}
	if (up < 2)
		return;
	report_add(&d->found, BOARD_MISSING,
	           "two owsd of the name %s run: in %s (process %d) and in %s (%d)", d->instance,
	           paths[0], pid[0], paths[1], pid[1]);
	report_command(&d->found, "kill %d    # or start it with another name, as -n TEST", pid[0]);
}

/* Was the file written after that? Two clocks, and one of them is coarse. */
static bool is_written_since(const struct doctor *d, int64_t boot_ns)
{
	struct when now = when_now();
	struct stat st;

	return !stat(d->file, &st) &&
	       now.boot - (now.wall - st.st_mtim.tv_sec * NS_PER_S - st.st_mtim.tv_nsec) >
	               boot_ns - 10 * NS_PER_MS;
}

/* The line of the configuration that the reason of a refusal names, 0: none. */
static int line_of(const struct doctor *d, const char *reason)
{
	size_t len = strlen(d->file);

	return !strncmp(reason, d->file, len) && reason[len] == ':'
	               ? (int)strtol(reason + len + 1, NULL, 10)
	               : 0;
}

static void check_refused(struct doctor *d)
{
	struct ows_log_line refused;
	char span[WHEN_TEXT], load[UNITS_COMMAND];
	int line;

	/* with errors in the file the remedy is above */
	if (d->errors || ows_refused_reload(d->ows, &refused))
		return;
	report_add(&d->found, BOARD_MISSING,
	           "owsd goes on with what it loaded before: a reload was refused %s ago: %s",
	           when_span(d->now_ns - refused.time_ns, span), refused.text);
	line = line_of(d, refused.text);
	if (line > 0 && !is_written_since(d, refused.time_ns))
		report_remedy(&d->found, "correct line %d of %s, then: %s", line, d->file,
		              units_load_command(d, load));
	else
		report_command(&d->found,
		               refused.level == 4 ? "sudo systemctl restart owsd@%s"
		                                  : "sudo owsctl -n %s reload",
		               d->instance);
}

static bool has_counted(struct ows *ows, const char *name)
{
	struct ows_counter counter;

	for (int i = 0; ows_counter(ows, i, &counter) == 0; i++)
		if (!strcmp(counter.name, name))
			return counter.value;
	return false;
}

/* owsd says that there is one: it may have it from -l, and not from the file. */
static void check_listen(struct doctor *d)
{
	const struct config_serve *serve = d->config ? &d->config->serve : NULL;
	char why[LISTEN_WHY_MAX] = "one is not of this machine, or another process has its port";
	struct sockaddr_storage at;
	bool absent = false;

	if (!has_counted(d->ows, "served_absent"))
		return;
	for (unsigned i = 0; serve && i < serve->address_count; i++) {
		listen_sockaddr(&serve->addresses[i], &at);
		if (listen_is_here(&at))
			continue;
		absent = true;
		listen_why(&serve->addresses[i], -EADDRNOTAVAIL, why);
	}
	report_add(&d->found, BOARD_MISSING, "owsd is not reached at each address of Listen: %s",
	           why);
	if (absent)
		report_remedy(&d->found, "%s", listen_remedy(-EADDRNOTAVAIL) + strlen("; "));
	else
		report_remedy(&d->found, "systemctl status owsd@%s names it, and the reason",
		              d->instance);
}

void check_owsd(struct doctor *d)
{
	const struct face_row service = {.program = "owsd"};
	const struct unit *unit = units_owsd(d);
	struct ows_daemon daemon = {0};

	if (d->alive) {
		check_twins(d);
		check_refused(d);
		check_listen(d);
		ows_daemon(d->ows, d->now_ns, &daemon);
		report_add(&d->found, BOARD_FACT,
		           "instance %s: process %d, %d signal%s, %d not good", d->instance,
		           (int)daemon.pid, ows_count(d->ows), ows_count(d->ows) == 1 ? "" : "s",
		           stats_not_good(d->ows, d->now_ns));
		return;
	}
	/* a service that fails is reported; of one of another machine there is no process */
	if (d->err == -EACCES || (unit && (*d->root || !unit_is_active(unit)) &&
	                          (unit_is_active(unit) || face_starts(d->root, unit->id))))
		return;
	report_add(&d->found, BOARD_MISSING, "owsd %s does not run: %s", d->instance,
	           d->err && d->err != -ENOENT ? strerror(-d->err) : "it has no heartbeat");
	if (unit_is_active(unit))
		report_command(&d->found, "sudo systemctl restart owsd@%s", d->instance);
	else if (face_is_installed(d->root, &service))
		report_command(&d->found, "sudo systemctl enable --now owsd@%s", d->instance);
	else
		report_command(&d->found, "owsd -n %s -c %s    # or install its service",
		               d->instance, d->file);
}

/* --- The programs beside it ------------------------------------------------------------------ */

/* Was the file written after the program read it? A minute is time for what writes it. */
static bool is_older(const struct doctor *d, const struct faces_one *face)
{
	struct when now = when_now();
	struct stat st;

	return !*d->root && face->loaded_ns && !stat(d->file, &st) &&
	       now.boot - (now.wall - st.st_mtim.tv_sec * NS_PER_S) >
	               face->loaded_ns + 60 * NS_PER_S;
}

static void check_report(struct doctor *d, const struct faces_one *face)
{
	char span[WHEN_TEXT];

	report_add(&d->found, BOARD_FACT, "%s: %s", face->program, face->status);
	if (!*d->root && faces_silent(face, d->now_ns)) {
		/* a program that has ended may have left its report */
		if (face->pid <= 0 || (kill((pid_t)face->pid, 0) && errno == ESRCH))
			return;
		report_add(&d->found, BOARD_MISSING, "%s has been silent for %s", face->program,
		           when_span(d->now_ns - face->beat_ns, span));
		report_command(&d->found, "sudo systemctl restart %s@%s", face->program,
		               d->instance);
	} else if (*face->refused && !d->errors) {
		report_add(&d->found, BOARD_MISSING, "%s refuses its file: %s", face->program,
		           face->refused);
		report_remedy(&d->found, "correct %s, then: sudo systemctl reload %s@%s", d->file,
		              face->program, d->instance);
	} else if (*face->trouble && !face->since_ns) {
		report_add(&d->found, BOARD_MISSING, "%s: %s", face->program, face->status);
		report_remedy(&d->found, SEEN_SAYS, face->program, face->trouble);
	} else if (is_older(d, face) && !d->errors) {
		report_add(&d->found, BOARD_MISSING,
		           "%s has not read the file since it was changed", face->program);
		report_command(&d->found, "sudo systemctl reload %s@%s", face->program,
		               d->instance);
	}
}

/* Does a face have what its block asks for? `owsctl enable` gives it. */
static void check_face(struct doctor *d, const struct face_row *row)
{
	const char *word = row->program + strlen("owsd-");
	bool there = face_is_installed(d->root, row);
	char id[FACE_UNIT];

	face_unit(row, d->instance, row->socket ? "socket" : "service", id);
	if (!there || !(unit_is_active(units_find(d, id)) || face_starts(d->root, id))) {
		if (!face_has_block(d->config, row->program))
			return;
		report_add(&d->found, BOARD_NOTE, "%s has a block for %s, which is %s", d->file,
		           row->program, there ? "not switched on" : "not installed");
		if (there)
			report_command(&d->found, "sudo owsctl -n %s enable %s", d->instance, word);
		else
			report_command(&d->found, "sudo apt install %s", row->package);
		return;
	}
	for (unsigned i = 0; i < FACE_RIGHTS; i++) {
		const struct face_right *right = &face_rights[i];

		if (!face_has(d->config, row->program, right->key) ||
		    seen_in_group(d->root, row->program, right->group))
			continue;
		report_add(&d->found, BOARD_MISSING,
		           "%s is on for %s, which is not in the group %s", right->key,
		           row->program, right->group);
		report_command(&d->found, "sudo owsctl -n %s enable %s", d->instance, word);
	}
}

void check_faces(struct doctor *d)
{
	struct faces_one faces[FACES_MOST];
	unsigned count = faces_read(d->instance, faces);
	char id[FACE_UNIT], addresses[400];

	for (unsigned i = 0; i < count; i++)
		check_report(d, &faces[i]);
	for (int i = 0; d->config && d->units && i < d->faces; i++)
		check_face(d, &d->face[i]);
	snprintf(id, sizeof(id), "owsd-web@%s.socket", d->instance);
	if (!d->config || !unit_is_active(units_find(d, id)))
		return;
	face_addresses(d->config, addresses, sizeof(addresses));
	report_add(&d->found, BOARD_FACT, "page: %s%s/run/owsd/%s.web", addresses,
	           *addresses ? " " : "", d->instance);
}
