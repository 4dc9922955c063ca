/* SPDX-License-Identifier: MIT */
/* Collects and prints the writer's answer. */
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/writer/answer.h"
#include "src/ground/text/printable.h"

static const char *const statuses[] = {
	[ANSWER_DONE] = "done",       [ANSWER_CONFLICT] = "conflict", [ANSWER_INVALID] = "invalid",
	[ANSWER_REFUSED] = "refused", [ANSWER_ERROR] = "error",
};
static const char *const reloads[] = {
	[ANSWER_NOT_ASKED] = NULL,
	[ANSWER_RELOADED] = "done",
	[ANSWER_RELOAD_REFUSED] = "refused",
	[ANSWER_NO_OWSD] = "none",
};

const char *answer_word(enum answer_status status)
{
	return statuses[status];
}

void answer_say(struct answer *answer, enum answer_status status, const char *format, ...)
{
	va_list args;
	char *text;

	answer->status = status;
	va_start(args, format);
	text = printable_line(format, args);
	va_end(args);
	snprintf(answer->why, sizeof(answer->why), "%s", text ? text : format);
	answer->why[printable(answer->why, strlen(answer->why))] = '\0';
	free(text);
}

void answer_problem(struct answer *answer, bool is_error, int line, int column, const char *text)
{
	if (!answer->out)
		answer->out = open_memstream(&answer->problems, &answer->problems_len);
	if (answer->out)
		fprintf(answer->out, "problem: %c %d %d %s\n", is_error ? 'E' : 'W', line, column,
		        text);
}

static void print_answer(const struct answer *answer, FILE *out)
{
	fprintf(out, "status: %s\n", statuses[answer->status]);
	if (answer->has_tag)
		fprintf(out, "tag: %s\n", answer->tag);
	if (reloads[answer->reload])
		fprintf(out, "reload: %s\n", reloads[answer->reload]);
	if (*answer->backup)
		fprintf(out, "backup: %s %" PRId64 "\n", answer->backup, answer->backup_ms);
	if (*answer->why)
		fprintf(out, "why: %s\n", answer->why);
	if (answer->problems)
		fwrite(answer->problems, 1, answer->problems_len, out);
	fputc('\n', out);
}

char *answer_print(struct answer *answer, size_t *len)
{
	char *text = NULL;
	FILE *out;

	if (answer->out)
		fflush(answer->out);
	out = open_memstream(&text, len);
	if (!out)
		return NULL;
	print_answer(answer, out);
	if (fclose(out) == 0)
		return text;
	free(text);
	return NULL;
}

void answer_free(struct answer *answer)
{
	if (answer->out)
		fclose(answer->out);
	free(answer->problems);
	*answer = (struct answer){0};
}
