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

#endif
