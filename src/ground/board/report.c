/* SPDX-License-Identifier: MIT */
/* The report of `--board`: its lines, in order of importance, and their remedies. */
#include <assert.h>
#include <stdarg.h>
#include <string.h>

#include "src/ground/board/report.h"
#include "src/ground/text/printable.h"
#include "src/ground/text/shell.h"

static void clean_text(char *text)
{
	text[printable(text, strlen(text))] = '\0';
}

void report_add(struct board_report *report, enum board_kind kind, const char *format, ...)
{
	struct board_line *line = &report->line[report->count];
	va_list args;

	report->missing |= kind == BOARD_MISSING;
	report->full = report->count == BOARD_LINES;
	if (report->full)
		return;
	report->count++;
	line->kind = kind;
	line->remedy[0] = '\0';
	va_start(args, format);
	vsnprintf(line->text, sizeof(line->text), format, args);
	va_end(args);
	clean_text(line->text);
}

void report_remedy(struct board_report *report, const char *format, ...)
{
	struct board_line *line = &report->line[report->count - 1];
	va_list args;

	if (report->full)
		return;
	va_start(args, format);
	vsnprintf(line->remedy, sizeof(line->remedy), format, args);
	va_end(args);
	clean_text(line->remedy);
}

void report_command(struct board_report *report, const char *format, ...)
{
	struct board_line *line = &report->line[report->count - 1];
	size_t used = 0, size = sizeof(line->remedy);
	char text[SHELL_WORD];
	va_list args;

	if (report->full)
		return;
	va_start(args, format);
	while (*format && used < size) {
		size_t plain = strcspn(format, "%");
		char *at = line->remedy + used;

		assert(plain || strchr("sdu", format[1]));
		if (plain)
			used += (size_t)snprintf(at, size - used, "%.*s", (int)plain, format);
		else if (format[1] == 's')
			used += (size_t)snprintf(at, size - used, "%s",
			                         shell_word(va_arg(args, const char *), text));
		else
			used += (size_t)snprintf(at, size - used, "%d", va_arg(args, int));
		format += plain ? plain : 2;
	}
	va_end(args);
	if (used >= size)
		line->remedy[0] = '\0';
	clean_text(line->remedy);
}

void report_sort(struct board_report *report)
{
	for (unsigned i = 1; i < report->count; i++)
		for (unsigned at = i; at > 0; at--) {
			struct board_line *line = &report->line[at], moved;

			if (line[-1].kind <= line->kind)
				break;
			moved = line[-1];
			line[-1] = *line;
			*line = moved;
		}
}

void board_print(const struct board_report *report, FILE *out)
{
	for (unsigned i = 0; i < report->count; i++) {
		const struct board_line *line = &report->line[i];

		fprintf(out, "%s%s\n",
		        line->kind == BOARD_MISSING ? "missing: "
		        : line->kind == BOARD_FACT  ? ""
		                                    : "note: ",
		        line->text);
		if (line->remedy[0])
			fprintf(out, "    %s\n", line->remedy);
	}
}
