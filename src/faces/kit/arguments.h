/* SPDX-License-Identifier: MIT */
/* The command line of a face: that of owsd, as far as it concerns a consumer. */
#pragma once

#include <stdbool.h>

#include "src/ground/text/log.h"

#define FACE_EXIT_RUN 1
#define FACE_EXIT_USAGE 2

/* An option that one face alone has; value NULL: none, and the program ends after check(). */
struct face_option {
	char letter;
	const char *word, *value, *help; /* "directory", "DIR", "where ..." */
	const char *more;                /* lines of the help on what main() takes itself; NULL */
};

struct face_arguments {
	const char *program;
	const char *file, *instance;
	char default_file[128];
	const char
		*option; /* the value of the face's own option, "" without one; NULL: not given */
	enum log_level level;
	bool check; /* read the configuration, and end */
};

/*
 * What a program in the background does first, and its command line. Returns -1: go on; else the
 * exit status, after printing the reason. The strings in *a are those of argv.
 */
int face_start(const char *program, const struct face_option *own, int argc, char **argv,
               struct face_arguments *a);

#define FACE_PATH 512
/*
 * The path of the socket INSTANCE.KIND in this user's directory for the files of owsd. 0, or a
 * negative errno after printing why.
 */
int face_socket(const struct face_arguments *a, const char *kind, char path[FACE_PATH]);
/* Print a line on stderr, made printable: names come from outside and must not steer a terminal. */
void face_complain(const char *program, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
