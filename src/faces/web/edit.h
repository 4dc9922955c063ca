/* SPDX-License-Identifier: MIT */
/*
 * "owsd-web --edit FILE": begins a configuration, or opens one, on a machine where no owsd need
 * run.
 */
#pragma once

#include <stdbool.h>

#define EDIT_HELP \
	"      --edit FILE     edit that configuration at " EDIT_ADDRESS \
	", and begin it if it is\n" \
	"                      not there: owsd-writer is started with it, and no owsd is needed\n"
#define EDIT_ADDRESS "127.0.0.1:8080"

/*
 * Where the command line begins with --edit: make the file if there is none, start owsd-writer for
 * it until this program ends, and put the command line that means the same into *argc and *argv.
 * False after printing why that is not possible.
 */
bool edit_begin(int *argc, char ***argv);
/* Make the file, with a page that may configure, where there is none. 0, or a negative errno. */
int edit_make(const char *file);
/* The name of an instance that its file has: new of new.rio; "edit" where that cannot be one. */
#define EDIT_NAME 64
void edit_name(const char *file, char name[EDIT_NAME]);
/* Was it so begun? Then the page may configure, whatever the file says. */
bool edit_is_on(void);
