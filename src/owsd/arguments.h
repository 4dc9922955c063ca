/* SPDX-License-Identifier: MIT */
/* owsd's command line, and what the one who typed it is told. */
#ifndef OWSD_ARGUMENTS_H
#define OWSD_ARGUMENTS_H

#include "src/config/config.h"
#include "src/shm/segment.h"
#include "src/text/log.h"

#define ARGUMENTS_DIR "/etc/owsd"
#define ARGUMENTS_LISTENS 16

#define EXIT_RUN 1
#define EXIT_USAGE 2

struct arguments {
	const char *file, *instance;
	char default_file[sizeof(ARGUMENTS_DIR "/.rio") + SEGMENT_NAME_MAX];
	const char *targets[CONFIG_TARGETS_MAX];
	unsigned target_count;
	const char *listens[ARGUMENTS_LISTENS];
	unsigned listen_count;
	enum log_level level;
	int rt_priority;
	bool check, board;
	bool needs_no_file; /* file is absent, and what is served is named by targets and listens */
	const char *board_id, *root;
};

/* -1: go on; else the exit status, and all is said. What *a points to is argv's. */
int arguments_parse(int argc, char **argv, struct arguments *a);
/* A line on stderr. Names come from outside: nothing in them may steer a terminal. */
void complain(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* The exit status of what only prints. */
int finish_output(void);

#endif
