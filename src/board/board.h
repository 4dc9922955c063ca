/* SPDX-License-Identifier: MIT */
/*
 * The board that this machine is, and what is missing there for a DS2482, as files tell it: no byte
 * goes over a wire. Blocks no longer than the files of /proc and /sys do.
 */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum board_kind {
	BOARD_FACT,
	BOARD_NOTE,    /* works, and could be better or may surprise */
	BOARD_MISSING, /* target i2c: cannot work */
};

#define BOARD_LINES 24
struct board_line {
	enum board_kind kind;
	char text[280];
	char mend[240]; /* for a shell; "" none */
};

struct board_report {
	struct board_line line[BOARD_LINES]; /* facts, then what is missing, then notes */
	unsigned count;
	bool missing;
	bool full; /* the line that was added last found no place */
};

/* The folder of the board data: $OWSD_BOARDS, else beside this program. */
void board_folder(char *folder, size_t size);

/*
 * Look at the files below root ("" is this machine's). id names a board that does not tell what it
 * is, as the file of its data is called; NULL: none. Returns 0, or why and -ENOENT: there is no such
 * board, -ENAMETOOLONG: root is longer than 256 characters. Data that cannot be read is a note.
 */
int board_look(const char *root, const char *folder, const char *id, struct board_report *report,
               char *why, size_t why_size);

/* On each line; what mends it is indented below. */
void board_print(const struct board_report *report, FILE *out);

#endif
