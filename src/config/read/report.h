/* SPDX-License-Identifier: MIT */
/*
 * What is wrong with a file, reported as "FILE:LINE:COLUMN: error: TEXT". The first 50 errors and
 * the first 50 warnings are passed on, all are counted.
 */
#pragma once

#include "src/config/read/config.h"

#define REPORT_MAX 50

struct rio_position {
	const char *file; /* NULL: the command line */
	int line, column; /* from 1; column counts characters; 0: none. Line 0: all of it */
};

void report_error(struct config_report *report, struct rio_position position, const char *format,
                  ...) __attribute__((format(printf, 3, 4)));
void report_warning(struct config_report *report, struct rio_position position, const char *format,
                    ...) __attribute__((format(printf, 3, 4)));
