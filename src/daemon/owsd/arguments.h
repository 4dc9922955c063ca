/* SPDX-License-Identifier: MIT */
/*
 * owsd's command line, and the messages about it to the user.
 *
 * Room src/daemon/owsd: the program: options, start-up, supervision, reload and end.
 */
#pragma once

#include "src/config/read/config.h"
#include "src/config/read/load.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/segment.h"

#define ARGUMENTS_LISTENS 16

#define EXIT_RUN 1
#define EXIT_USAGE 2

struct arguments {
	const char *file, *instance;
	char default_file[sizeof(CONFIG_DIR "/.rio") + SEGMENT_NAME_MAX];
	const char *targets[CONFIG_TARGETS_MAX];
	unsigned target_count;
	const char *listens[ARGUMENTS_LISTENS];
	unsigned listen_count;
	enum log_level level;
	int rt_priority;
	bool check, strict, board;
	bool needs_no_file; /* file is absent, and what is served is named by targets and listens */
	const char *board_id, *root;
};

/*
 * Returns -1: go on; else the exit status, after printing the reason. The strings in *a are those
 * of argv.
 */
int arguments_parse(int argc, char **argv, struct arguments *a);
/* Print a line on stderr, made printable: names come from outside and must not steer a terminal. */
void complain(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* Close stdout; returns the exit status of an option that only prints. */
int finish_output(void);
