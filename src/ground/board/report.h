/* SPDX-License-Identifier: MIT */
/* Inside src/ground/board: adds lines to a report. */
#pragma once

#include "src/ground/board/board.h"

/* Add a line. Control characters from a file are cleaned. */
void report_add(struct board_report *report, enum board_kind kind, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
/* Set the remedy of the last line. */
void report_remedy(struct board_report *report, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
/*
 * The same with a command: each "%s" is a word of it, and put into quotes where the shell wants it.
 * "%d" and "%u" are the others. A command that does not fit is none: a half one does another thing.
 */
void report_command(struct board_report *report, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
/* Sort: what is missing stands before the notes; else the order stays. */
void report_sort(struct board_report *report);

/* Print each line, and its remedy indented below it. */
void board_print(const struct board_report *report, FILE *out);
