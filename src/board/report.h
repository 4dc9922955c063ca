/* SPDX-License-Identifier: MIT */
/* Inside src/board: lines are added to a report. */
#ifndef BOARD_REPORT_H
#define BOARD_REPORT_H

#include "src/board/board.h"

/* A line, and behind it its mend; what comes from a file may hold anything. */
void report_add(struct board_report *report, enum board_kind kind, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
/* The mend of the line that was added last. */
void report_mend(struct board_report *report, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
/* What is missing before the notes, else in the order in which it was added. */
void report_sort(struct board_report *report);

/* On each line; what mends it is indented below. */
void board_print(const struct board_report *report, FILE *out);

#endif
