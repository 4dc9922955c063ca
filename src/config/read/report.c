/* SPDX-License-Identifier: MIT */
/* Errors and warnings about a configuration, formatted with their position and passed on. */
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/read/report.h"
#include "src/ground/text/printable.h"

#define MESSAGE_MAX (PRINTABLE_LINE + 300)

static void __attribute__((format(printf, 4, 0)))
put_line(struct config_report *report, struct rio_position position, bool is_error,
         const char *format, va_list args)
{
	unsigned *count = is_error ? &report->errors : &report->warnings;
	const char *kind = is_error ? "error" : "warning";
	char message[MESSAGE_MAX] = "", *text = NULL;
	int n;

	if (++*count > REPORT_MAX + 1 || (!report->line && !report->problem))
		return;
	report->at_line = *count > REPORT_MAX ? INT_MAX : position.line;
	if (report->problem)
		n = 0;
	else if (position.file && position.line && !position.column)
		n = snprintf(message, sizeof(message), "%.200s:%d: %s: ", position.file,
		             position.line, kind);
	else if (position.file && position.line)
		n = snprintf(message, sizeof(message), "%.200s:%d:%d: %s: ", position.file,
		             position.line, position.column, kind);
	else if (position.file)
		n = snprintf(message, sizeof(message), "%.200s: %s: ", position.file, kind);
	else
		n = snprintf(message, sizeof(message), "%s: ", kind);
	if (*count > REPORT_MAX)
		snprintf(message + n, sizeof(message) - (size_t)n,
		         "more than %d %ss, the rest is not shown", REPORT_MAX, kind);
	else if ((text = printable_line(format, args)))
		snprintf(message + n, sizeof(message) - (size_t)n, "%s", text);
	free(text);
	/* the message quotes values of the file, which may hold control characters */
	message[printable(message, strlen(message))] = '\0';
	if (!report->problem)
		report->line(report->ctx, is_error, message);
	else if (*count > REPORT_MAX)
		report->problem(report->ctx, is_error, 0, 0, message);
	else
		report->problem(report->ctx, is_error, position.line, position.column, message);
}

void report_error(struct config_report *report, struct rio_position position, const char *format,
                  ...)
{
	va_list args;

	va_start(args, format);
	put_line(report, position, true, format, args);
	va_end(args);
}

void report_warning(struct config_report *report, struct rio_position position, const char *format,
                    ...)
{
	va_list args;

	va_start(args, format);
	put_line(report, position, false, format, args);
	va_end(args);
}
