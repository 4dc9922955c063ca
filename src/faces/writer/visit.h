/* SPDX-License-Identifier: MIT */
/*
 * A connection to the writer: looks which user it is, takes one order, answers, and hangs up.
 *
 * Room src/faces/writer: the program owsd-writer: replaces the configuration of an instance, and
 * has owsd reload.
 */
#pragma once

#include <stdbool.h>
#include <sys/types.h>

struct log;

struct writer {
	const char *file, *instance;
	bool has_group; /* else only root and this user may write */
	uid_t owsd; /* which is in the group to serve it, and has no part in the configuration */
	gid_t group;
	struct log *log;
};

/*
 * In a process of its own: SIGTERM and SIGINT end it but while a change is under way. The
 * connection is not blocking, and ends with the process. may: else the user has too many visits.
 * Takes ten seconds for the request and ten for the answer at most, five to lock the file, and half
 * a minute for the reload.
 */
void visit(const struct writer *writer, int connection, bool may);
