/* SPDX-License-Identifier: MIT */
/* What the checks of owsctl doctor share: the machine that they look at, and what they found. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/ground/board/report.h"
#include "src/public/ows.h"
#include "src/tool/owsctl/machine/faces.h"
#include "src/tool/owsctl/running.h"

/* A unit, as `systemctl list-units` has it. */
struct unit {
	char id[FACE_UNIT], active[16], sub[24];
};

#define UNITS (2 * FACE_ROWS + 1)
#define DOCTOR_TEXT 16384
#define DOCTOR_ROOT 150 /* the longest root: run/owsd in it is the directory of instances */

struct doctor {
	const char *root; /* "": this machine; else where the files of a recorded one are */
	const char *instance;
	struct board_report found; /* a remedy is a command of a shell, or what to look at */
	const char *check[BOARD_LINES];
	char file[INSTANCE_FIELD]; /* the configuration */
	struct config *config;     /* NULL: it is wrong, or there is none */
	unsigned errors;
	struct face_row face[FACE_ROWS];
	int faces;
	struct unit unit[UNITS];
	unsigned units; /* 0: no systemd runs here, or none of the instance */
	struct ows *ows;
	int err; /* why ows is NULL */
	int64_t now_ns;
	bool alive;
	struct board_report board;
	char text[DOCTOR_TEXT]; /* what a command printed last */
};

/*
 * A remedy in the words of a program: its name, the words. One that was taken over writes them too,
 * and who reads them is root, so they never look like a command of owsctl's.
 */
#define SEEN_SAYS "%s says: %s"

/* The output of a command, in d->text; of a recorded machine its file recorded/NAME. */
bool seen_output(struct doctor *d, const char *name, const char *const words[]);
/* Does a program of this machine listen at the port of an owserver? */
bool seen_owserver(const char *root);
/* Does owsd look by itself which way there is? */
bool seen_automatic(const struct doctor *d);
/*
 * Is the target an owserver of this machine whose service is installed, and nobody listens? One
 * that somebody has disabled is none of the ways of auto.
 */
bool seen_owserver_stopped(const struct doctor *d, const char *target);
/*
 * Is the user a member of the group, by etc/group below the root? NULL: is anybody who is none of
 * the users of owsd and its programs?
 */
bool seen_in_group(const char *root, const char *user, const char *group);
