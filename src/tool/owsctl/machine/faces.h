/* SPDX-License-Identifier: MIT */
/* The programs beside owsd, by their table board/faces, and what a configuration asks of them. */
#pragma once

#include <glob.h>
#include <stdbool.h>
#include <stddef.h>

struct config;

#define FACE_ROWS 16
#define FACE_UNIT 320 /* a unit with the longest name of an instance */

struct face_row {
	char program[32]; /* "owsd-web" */
	char package[32];
	bool socket; /* a socket starts its instances */
};

/* What a face may do by a key of its block: the group it needs, and the face that it asks to. */
struct face_right {
	const char *key, *group, *helper;
};
#define FACE_RIGHTS 3
extern const struct face_right face_rights[FACE_RIGHTS];

/* Read the table: how many rows, or a negative errno of its file. */
int faces_table(struct face_row rows[FACE_ROWS]);
/* The row of "web" or "owsd-web", and of "history"; NULL: none. */
const struct face_row *faces_find(const struct face_row *rows, int count, const char *word);
/* Has the configuration the block of the program? */
bool face_has_block(const struct config *config, const char *program);
/* Can that block have the key? NULL: can there be a block? */
bool face_may(const char *program, const char *key);
/* Has it the key, and if it is a flag, is it on? */
bool face_has(const struct config *config, const char *program, const char *key);
/* "owsd-web@OWS.socket"; what: "socket" or "service". Returns unit. */
const char *face_unit(const struct face_row *row, const char *instance, const char *what,
                      char unit[FACE_UNIT]);
/*
 * The files of a pattern such as "systemd/system/owsd*" in the folders below a root where systemd
 * looks; how many. One may be there twice. found is for globfree().
 */
size_t faces_files(const char *root, const char *pattern, glob_t *found);
/* Has the machine below the root the units of the face? */
bool face_is_installed(const char *root, const struct face_row *row);
/* Does the unit start with the machine below the root? */
bool face_starts(const char *root, const char *unit);
/* The addresses of its page, "http://127.0.0.1:8080/", with blanks between; "" none. */
void face_addresses(const struct config *config, char *text, size_t size);
