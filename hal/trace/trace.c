/* SPDX-License-Identifier: MIT */
/* The lines of a recording: written, read, and looked up. */
#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/file.h"
#include "hal/base/time.h"
#include "hal/trace/trace.h"

#define NOTES 10 /* in all */
#define TOOK_MOST_MS 10e3

static const struct {
	const char *name;
	int err;
} errors[] = {
#define ERROR(name) {#name, name},
	BUS_ERRORS(ERROR) ERROR(EHOSTDOWN) ERROR(EAGAIN)
#undef ERROR
};
#define ERRORS (sizeof(errors) / sizeof(errors[0]))

__attribute__((format(printf, 2, 0))) static void add(struct trace_text *text, const char *format,
                                                      va_list args)
{
	va_list again;
	int n;

	va_copy(again, args);
	n = vsnprintf(NULL, 0, format, again);
	va_end(again);
	if (n < 0)
		return;
	if (text->len + (size_t)n + 1 > text->room) {
		size_t room = 2 * text->room + (size_t)n + 128;
		char *more = realloc(text->text, room);

		if (!more)
			return;
		text->text = more;
		text->room = room;
	}
	vsnprintf(text->text + text->len, (size_t)n + 1, format, args);
	text->len += (size_t)n;
}

void trace_add(struct trace_text *text, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	add(text, format, args);
	va_end(args);
}

void trace_bytes(struct trace_text *text, const uint8_t *bytes, size_t n, bool quoted)
{
	trace_add(text, quoted ? "\"" : n ? "" : "-");
	for (size_t i = 0; i < n; i++)
		if (quoted && bytes[i] >= ' ' && bytes[i] < 127 && !strchr("\"\\>", bytes[i]))
			trace_add(text, "%c", bytes[i]);
		else
			trace_add(text, quoted ? "\\%02X" : "%02X", bytes[i]);
	trace_add(text, quoted ? "\"" : "");
}

static int digit(char c)
{
	static const char digits[] = "0123456789abcdef";
	const char *at = c ? strchr(digits, tolower((unsigned char)c)) : NULL;

	return at ? (int)(at - digits) : -1;
}

size_t trace_parse(const char *text, uint8_t *bytes, size_t n)
{
	bool quoted = *text == '"';
	size_t count = 0;

	for (text += quoted; count < n && *text && *text != '"'; count++) {
		int high, low;

		if (quoted && *text != '\\') {
			bytes[count] = (uint8_t)*text++;
			continue;
		}
		text += quoted;
		high = digit(text[0]);
		low = high < 0 ? -1 : digit(text[1]);
		if (low < 0)
			break;
		bytes[count] = (uint8_t)(high << 4 | low);
		text += 2;
	}
	return count;
}

void trace_ask(struct trace *trace, const struct bus_env *env, const char *format, ...)
{
	va_list args;

	trace->question.len = 0;
	trace->begun_ns = bus_now(env);
	if (!trace->since_ns)
		trace->since_ns = trace->begun_ns;
	va_start(args, format);
	add(&trace->question, format, args);
	va_end(args);
}

void trace_note(struct trace *trace, const struct bus_env *env, const char *format, ...)
{
	char text[BUS_EVENT_TEXT];
	va_list args;

	if (trace->notes > NOTES)
		return;
	va_start(args, format);
	vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	if (trace->notes++ == NOTES)
		snprintf(text, sizeof(text), "%s: more is not shown", trace->name);
	bus_report(env, BUS_NOTE, 0, text);
}

/* --- Recording --- */

static void write_line(struct trace *trace, int64_t now_ns, const struct trace_place *place)
{
	int n;

	if (!trace->left || !trace->question.text || !trace->answer.text)
		return;
	n = fprintf(trace->file, "%.4f %.3f %s %s > %s\n",
	            (double)(trace->begun_ns - trace->since_ns) / 1e9,
	            (double)(now_ns - trace->begun_ns) / 1e6, place->name, trace->question.text,
	            trace->answer.text);
	trace->left -= n > 0 && (size_t)n < trace->left ? (size_t)n : trace->left;
	trace->lines++;
	if (trace->progress)
		trace->progress(trace);
	if (!trace->left)
		fputs("# it is full: what followed is left out\n", trace->file);
}

bool trace_full(const struct trace *trace)
{
	return !trace->left;
}

void trace_result_text(struct trace_text *text, int result, const uint8_t *bytes, size_t n,
                       bool quoted)
{
	size_t i = 0;

	text->len = 0;
	while (i < ERRORS && errors[i].err != -result)
		i++;
	if (i < ERRORS)
		trace_add(text, "!%s", errors[i].name);
	else
		trace_add(text, "%d", result);
	if (n)
		trace_add(text, " ");
	if (n)
		trace_bytes(text, bytes, n, quoted);
}

/* --- Replaying --- */

int trace_result(const char *answer)
{
	size_t len = strcspn(answer, " ");

	for (size_t i = 0; i < ERRORS; i++)
		if (*answer == '!' && strlen(errors[i].name) == len - 1 &&
		    memcmp(errors[i].name, answer + 1, len - 1) == 0)
			return -errors[i].err;
	return *answer == '!' ? -EIO : (int)strtol(answer, NULL, 10);
}

static const char *bytes_of(const char *answer)
{
	const char *blank = strchr(answer, ' ');

	return blank ? blank + 1 : "";
}

/* Cuts a line into its parts. False: it is a remark, or none of a recording. */
static bool cut_line(char *text, struct trace_line *line)
{
	char *rest, *place, *arrow = strstr(text, " > ");

	if (*text == '#' || !arrow)
		return false;
	*arrow = '\0';
	strtod(text, &rest);
	line->took_ms = strtod(rest, &rest);
	place = rest + strspn(rest, " ");
	rest = place + strcspn(place, " ");
	if (!*rest)
		return false;
	*rest = '\0';
	line->place = place;
	line->question = rest + 1;
	line->answer = arrow + 3;
	if (!(line->took_ms >= 0 && line->took_ms < TOOK_MOST_MS))
		line->took_ms = TOOK_MOST_MS;
	return true;
}

static size_t find_before(const struct trace *trace, const struct trace_line *line)
{
	size_t i = trace->lines;

	while (i && strcmp(trace->line[i - 1].place, line->place) != 0)
		i--;
	return i;
}

/* Does the question go on with a transaction? Then what was before it counts. */
static bool goes_on(const char *question)
{
	static const char *const words[] = {"run - ", "slot ", "triplet", "path "};

	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
		if (strncmp(question, words[i], strlen(words[i])) == 0)
			return true;
	return false;
}

/* Of a line and what is ahead of it in its transaction: FNV-1a. */
static uint64_t chain_of(const struct trace *trace, const struct trace_line *line)
{
	bool on = goes_on(line->question) && line->before;
	uint64_t chain = on ? trace->line[line->before - 1].chain : 0;

	for (const char *at = line->question; *at; at++)
		chain = (chain ^ (uint8_t)*at) * UINT64_C(0x100000001b3);
	for (const char *at = line->answer; *at; at++)
		chain = (chain ^ (uint8_t)*at) * UINT64_C(0x100000001b3);
	return chain;
}

/* What is ahead of the line in its transaction is what was given ahead of this question. */
static bool follows(const struct trace *trace, const struct trace_place *place,
                    const struct trace_line *line)
{
	return place->told && line->before &&
	       trace->line[line->before - 1].chain == trace->line[place->last].chain;
}

int trace_read(struct trace *trace, const char *name, char *why, size_t why_size)
{
	int err = 0;
	size_t count = 1, number = 1;

	trace->name = name;
	trace->text = file_text(name, TRACE_MOST, &err, why, why_size);
	if (!trace->text)
		return err;
	if (strncmp(trace->text, TRACE_BEGIN, strlen(TRACE_BEGIN)) != 0) {
		snprintf(why, why_size, "%.100s is no recording: owsctl record makes one", name);
		return -EINVAL;
	}
	for (const char *at = trace->text; (at = strchr(at, '\n')); at++)
		count++;
	trace->lines = 0;
	trace->line = calloc(count, sizeof(*trace->line));
	if (!trace->line)
		return -ENOMEM;
	for (char *at = trace->text, *end; at; at = end, number++) {
		struct trace_line line = {.number = number};

		end = strchr(at, '\n');
		if (end)
			*end++ = '\0';
		if (!cut_line(at, &line) || trace->lines == TRACE_LINES)
			continue;
		line.before = find_before(trace, &line);
		line.chain = chain_of(trace, &line);
		trace->line[trace->lines++] = line;
	}
	return 0;
}

/* Where devices differed, were the directions taken that are asked for now? */
static bool fits(const struct trace_place *place, const char *answer)
{
	uint8_t taken[16] = {0};
	int bits = trace_result(answer);

	if (place->direction_n == 1)
		return bits < 0 || bits & 3 || (bits >> 2 & 1) == *place->directions;
	trace_parse(bytes_of(answer), taken, sizeof(taken));
	for (size_t i = 0; i < place->direction_n; i++)
		if ((taken[i] ^ place->directions[i]) & taken[8 + i])
			return false;
	return true;
}

/* How often a driver of a DS2482 reads its status in a transaction is a matter of time. */
static bool is_same(const char *question, const char *recorded)
{
	const char *last = strrchr(question, ' ');
	size_t len = last ? (size_t)(last - question) + 1 : 0;

	if (!last || strncmp(question, "transfer ", 9) != 0 || last[-1] != 'r')
		return strcmp(question, recorded) == 0;
	return strncmp(question, recorded, len) == 0 && !strchr(recorded + len, ' ');
}

static const struct trace_line *next_of(const struct trace *trace, const struct trace_place *place)
{
	for (size_t i = place->told ? place->last + 1 : 0; i < trace->lines; i++)
		if (strcmp(trace->line[i].place, place->name) == 0 &&
		    strncmp(trace->line[i].question, "link ", 5) != 0)
			return &trace->line[i];
	return NULL;
}

/* From the line given last on, and then from the beginning: a replay has no end. */
const struct trace_line *trace_find(struct trace *trace, const struct bus_env *env,
                                    struct trace_place *place)
{
	const char *question = trace->question.text ? trace->question.text : "";
	size_t first = place->told ? place->last + 1 : 0;
	const struct trace_line *expected = next_of(trace, place);
	bool on = goes_on(question);

	for (size_t i = 0; i < trace->lines; i++) {
		size_t at = (first + i) % trace->lines;
		const struct trace_line *line = &trace->line[at];

		if (strcmp(line->place, place->name) != 0 || !is_same(question, line->question) ||
		    !fits(place, line->answer) || (on && !follows(trace, place, line)))
			continue;
		if (expected && line != expected)
			trace_note(trace, env, "%s:%zu: recorded is \"%.50s\", asked \"%.50s\"",
			           trace->name, expected->number, expected->question, question);
		place->told = true;
		place->last = at;
		return line;
	}
	trace_note(trace, env, "%s: never asked in it: \"%.80s\"", trace->name, question);
	return NULL;
}

int trace_told(struct trace *trace, const struct bus_env *env, struct trace_place *place,
               int result, uint8_t *bytes, size_t *n)
{
	const struct trace_line *line;
	int64_t until_ns;

	if (trace->file) {
		trace_result_text(&trace->answer, result, bytes, *n, place->quotes);
		write_line(trace, trace->ended_ns ? trace->ended_ns : bus_now(env), place);
		return result;
	}
	line = trace_find(trace, env, place);
	/* An answer may be shorter than what was asked for */
	if (*n)
		memset(bytes, 0xff, *n);
	if (!line) {
		*n = 0;
		return -EHOSTDOWN;
	}
	until_ns = trace->begun_ns + (int64_t)(line->took_ms * NS_PER_MS);
	*n = trace_parse(bytes_of(line->answer), bytes, *n);
	if (env->wait(env->ctx, -1, 0, until_ns) == -ECANCELED)
		return -ECANCELED;
	return trace_result(line->answer);
}

bool trace_has(const struct trace *trace, const char *place)
{
	for (unsigned i = 0; i < trace->lines; i++)
		if (strcmp(trace->line[i].place, place) == 0)
			return true;
	return false;
}

void trace_free(struct trace *trace)
{
	free(trace->question.text);
	free(trace->answer.text);
	free(trace->line);
	free(trace->text);
}
