/* SPDX-License-Identifier: MIT */
/* The lines of a recording: written, and looked up in the text of the file. */
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/owfs/path.h"
#include "hal/trace/lines.h"

#define NOTES 10 /* in all */
#define TOOK_MOST_MS 10e3
#define REST_OF_LINE 100 /* what a line has beside question and answer is less */
#define SHOWN 50         /* of a text in a message */
#define TEXT_LEAST 4     /* bytes that are shown as text among others */

static const struct {
	const char *name;
	int err;
} errors[] = {
#define ERROR(name) {#name, name},
	BUS_ERRORS(ERROR) ERROR(EHOSTDOWN) ERROR(EADDRINUSE)
#undef ERROR
};
#define ERRORS (sizeof(errors) / sizeof(errors[0]))

static size_t printable(const uint8_t *bytes, size_t n)
{
	size_t count = 0;

	while (count < n && bytes[count] >= ' ' && bytes[count] < 127 &&
	       !strchr("\">=!", bytes[count]))
		count++;
	return count;
}

void trace_bytes(FILE *file, const uint8_t *bytes, size_t n, enum trace_form form)
{
	if (!n)
		fputc('-', file);
	for (size_t i = 0, shown; i < n; i += shown) {
		shown = form == TRACE_TEXT ? printable(bytes + i, n - i) : 0;
		if (shown >= TEXT_LEAST || (shown && shown == n)) {
			fprintf(file, "\"%.*s\"", (int)shown, (const char *)bytes + i);
			continue;
		}
		fprintf(file, form == TRACE_IDS && i % 8 == 0 ? "%02X." : "%02X", bytes[i]);
		shown = 1;
	}
}

size_t trace_parse(const char *text, uint8_t *bytes, size_t n)
{
	bool quoted = false;
	size_t count = 0;

	for (; count < n && *text && *text != '\n'; text++) {
		int high = hex_digit(text[0]), low = high < 0 ? -1 : hex_digit(text[1]);

		if (*text == '"')
			quoted = !quoted;
		else if (quoted)
			bytes[count++] = (uint8_t)*text;
		else if (low >= 0)
			bytes[count++] = (uint8_t)(high << 4 | low), text++;
		else if (*text != '.' && *text != ' ')
			break;
	}
	return count;
}

void trace_more(struct lines *lines, const uint8_t *bytes, size_t n)
{
	if (!n)
		return;
	fputc(' ', lines->now);
	trace_bytes(lines->now, bytes, n, lines->form);
}

FILE *trace_ask(struct lines *lines, const struct bus_env *env, struct place *place)
{
	lines->env = env;
	lines->place = place;
	lines->form = TRACE_HEX;
	lines->directions = NULL;
	lines->begun_ns = bus_now(env);
	if (!lines->trace.since_ns)
		lines->trace.since_ns = lines->begun_ns;
	rewind(lines->now);
	fprintf(lines->now, " %s: ", place->name);
	return lines->now;
}

const char *trace_asked(struct lines *lines)
{
	fprintf(lines->now, " >%c", '\0');
	fflush(lines->now);
	return lines->text;
}

const char *trace_result(struct lines *lines, int result)
{
	size_t i = 0;

	while (i < ERRORS && -errors[i].err != result)
		i++;
	if (i < ERRORS)
		fprintf(lines->now, " !%s", errors[i].name);
	else if (result)
		fprintf(lines->now, " =%d", result);
	fputc('\0', lines->now);
	fflush(lines->now);
	return lines->text + strlen(lines->text) + 1;
}

static int result_of(const char *answer, int most)
{
	const char *at = answer + strcspn(answer, "=!\n");
	size_t len = strcspn(at, "\n");
	long result = *at == '=' ? strtol(at + 1, NULL, 10) : 0;

	for (size_t i = 0; i < ERRORS && *at == '!'; i++)
		if (strlen(errors[i].name) == len - 1 &&
		    memcmp(errors[i].name, at + 1, len - 1) == 0)
			return -errors[i].err;
	return *at == '!' || result < 0 || result > most ? -EIO : (int)result;
}

/* --- Recording --- */

void trace_write(struct lines *lines, int result, int64_t now_ns)
{
	struct trace *trace = &lines->trace;
	const char *answer = trace_result(lines, result);
	int n;

	if (!trace->left)
		return;
	if (strlen(lines->text) + strlen(answer) + REST_OF_LINE > trace->left) {
		trace->left = 0;
		fputs("# it is full: what followed is left out\n", trace->file);
		return;
	}
	n = fprintf(trace->file, "%.4f %.3f%s%s\n",
	            (double)(lines->begun_ns - trace->since_ns) / 1e9,
	            (double)(now_ns - lines->begun_ns) / 1e6, lines->text, answer);
	trace->left -= n > 0 ? (size_t)n : 0;
	trace->lines++;
	if (trace->progress)
		trace->progress(trace);
}

/* --- Replaying --- */

int trace_shown(const char *text, const char *end)
{
	size_t n = strcspn(text, end);

	return n < SHOWN ? (int)n : SHOWN;
}

void trace_note(struct lines *lines, const char *at, const char *format, ...)
{
	char text[BUS_EVENT_TEXT];
	unsigned number = 1;
	va_list args;
	int n;

	if (lines->notes > NOTES)
		return;
	for (const char *c = lines->whole; c < at; c++)
		number += *c == '\n';
	n = snprintf(text, sizeof(text), "%.100s:%u: ", lines->name, number);
	va_start(args, format);
	vsnprintf(text + n, sizeof(text) - (size_t)n, format, args);
	va_end(args);
	if (lines->notes++ == NOTES)
		snprintf(text, sizeof(text), "%s: more is not told", lines->name);
	bus_report(lines->env, BUS_NOTE, 0, text);
}

/* Of a search: were the directions taken that are asked for now, where devices differed? */
static bool fits(const uint8_t *directions, const char *answer)
{
	uint8_t both[16] = {0};

	if (directions)
		trace_parse(answer, both, sizeof(both));
	for (size_t i = 0; directions && i < 8; i++)
		if ((both[i] ^ directions[i]) & (both[i] ^ both[8 + i]))
			return false;
	return true;
}

static const char *find_from(const struct lines *lines, const char *at)
{
	size_t len = strlen(lines->text);

	while ((at = strstr(at, lines->text)) && !fits(lines->directions, at + len))
		at++;
	return at ? at + len : NULL;
}

/* From the line given last on, and then from the beginning: a replay has no end. */
const char *trace_find(struct lines *lines)
{
	const char *question = trace_asked(lines), *at, *expected;
	struct place *place = lines->place;
	char name[8], *rest;

	if (!place->last)
		place->last = lines->whole;
	at = find_from(lines, place->last);
	if (!at)
		at = find_from(lines, lines->whole);
	if (!at) {
		trace_note(lines, place->last, "never asked:%.80s", question);
		return NULL;
	}
	snprintf(name, sizeof(name), " %s: ", place->name);
	expected = strstr(place->last, name);
	if (expected && expected != at - strlen(question))
		trace_note(lines, expected, "recorded is%.*s, asked%.50s",
		           trace_shown(expected, ">\n"), expected, question);
	place->last = at;
	while (at > lines->whole && at[-1] != '\n')
		at--;
	strtod(at, &rest);
	lines->took_ms = strtod(rest, NULL);
	return place->last;
}

int trace_pass(struct lines *lines, const char *answer, int most)
{
	const struct bus_env *env = lines->env;
	double ms = lines->took_ms >= 0 && lines->took_ms < TOOK_MOST_MS ? lines->took_ms
	                                                                 : TOOK_MOST_MS;

	if (env->wait(env->ctx, -1, 0, lines->begun_ns + (int64_t)(ms * NS_PER_MS)) == -ECANCELED)
		return -ECANCELED;
	return result_of(answer, most);
}

int trace_told(struct lines *lines, int most, int result, uint8_t *bytes, size_t *n)
{
	const char *answer;

	if (lines->trace.file) {
		trace_asked(lines);
		trace_more(lines, bytes, *n);
		trace_write(lines, result, bus_now(lines->env));
		return result;
	}
	answer = trace_find(lines);
	/* An answer may be shorter than what was asked for */
	if (*n)
		memset(bytes, 0xff, *n);
	*n = answer ? trace_parse(answer, bytes, *n) : 0;
	return answer ? trace_pass(lines, answer, most) : -EHOSTDOWN;
}
