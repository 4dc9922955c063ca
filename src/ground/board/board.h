/* SPDX-License-Identifier: MIT */
/*
 * The board that this machine is, and what the board lacks for a DS2482, as files show it: no byte
 * goes over a wire. Blocks no longer than the files of /proc and /sys do.
 *
 * Room src/ground/board: which board this machine is, and what it lacks.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum board_kind {
	/* in the order of the report */
	BOARD_FACT,
	BOARD_MISSING, /* target i2c: cannot work */
	BOARD_RIVAL,   /* another program disturbs it */
	BOARD_NOTE,    /* works, but could be better or may surprise */
};

#define BOARD_LINES 40
struct board_line {
	enum board_kind kind;
	char text[400];
	char remedy[1000]; /* for a shell; "" none */
};

struct board_report {
	struct board_line line[BOARD_LINES]; /* facts, then what is missing, then notes */
	unsigned count;
	bool missing;
	/* What gives the kernel a 1-Wire master at a GPIO pin; "": it has one, or nothing does */
	char master[240];
	bool full; /* the last line that was added found no place */
};
