/* SPDX-License-Identifier: MIT */
/* The lines of a recording: written, read, and looked up. */
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/file.h"
#include "hal/base/time.h"
#include "hal/owfs/path.h"
#include "hal/trace/trace.h"

#define NOTES 10 /* in all */
#define TOOK_MOST_MS 10e3
#define REST_OF_LINE 100 /* what a line has beside question and answer is less */

static const struct {
	const char *name;
	int err;
} errors[] = {
#define ERROR(name) {#name, name},
	BUS_ERRORS(ERROR) ERROR(EHOSTDOWN) ERROR(EADDRINUSE)
#undef ERROR
};
#define ERRORS (sizeof(errors) / sizeof(errors[0]))

static const char *const places[] = {"net", "i2c", "bus"}; /* from TRACE_NET on */

__attribute__((format(printf, 2, 0))) static void add(struct trace_text *text, const char *format,
                                                      va_list args)
{
	size_t room = sizeof(text->text) - text->len;
	int n = vsnprintf(text->text + text->len, room, format, args);

	if (n > 0)
		text->len += (size_t)n < room ? (size_t)n : room - 1;
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
	if (quoted && text->len && text->text[text->len - 1] == '"')
		text->len--;
	else
		trace_add(text, quoted ? "\"" : n ? "" : "-");
	for (size_t i = 0; i < n; i++)
		if (quoted && bytes[i] >= ' ' && bytes[i] < 127 && !strchr("\"\\>", bytes[i]))
			trace_add(text, "%c", bytes[i]);
		else
			trace_add(text, quoted ? "\\%02X" : "%02X", bytes[i]);
	trace_add(text, quoted ? "\"" : "");
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
		high = hex_digit(text[0]);
		low = high < 0 ? -1 : hex_digit(text[1]);
		if (low < 0)
			break;
		bytes[count] = (uint8_t)(high << 4 | low);
		text += 2;
	}
	return count;
}

void trace_ask(struct trace *trace, const struct bus_env *env, unsigned place, const char *format,
               ...)
{
	va_list args;

	trace->env = env;
	trace->place = place;
	trace->direction_n = trace->question.len = trace->answer.len = 0;
	trace->answer.text[0] = '\0';
	trace->begun_ns = bus_now(env);
	if (!trace->since_ns)
		trace->since_ns = trace->begun_ns;
	va_start(args, format);
	add(&trace->question, format, args);
	va_end(args);
}

void trace_note(struct trace *trace, const char *format, ...)
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
	bus_report(trace->env, BUS_NOTE, 0, text);
}

/* --- Recording --- */

const char *trace_result_text(int result, char text[TRACE_RESULT])
{
	size_t i = 0;

	while (i < ERRORS && -errors[i].err != result)
		i++;
	if (i < ERRORS)
		snprintf(text, TRACE_RESULT, "!%s", errors[i].name);
	else
		snprintf(text, TRACE_RESULT, "%d", result);
	return text;
}

void trace_write(struct trace *trace, int result, int64_t now_ns)
{
	size_t len = trace->question.len + trace->answer.len;
	char number[12], text[TRACE_RESULT];
	int n;

	if (!trace->left)
		return;
	/* of what a cut text is, a replay would make something else */
	if (len + REST_OF_LINE > trace->left || trace->question.len == TRACE_TEXT - 1 ||
	    trace->answer.len == TRACE_TEXT - 1) {
		trace->left = 0;
		fputs("# it is full: what followed is left out\n", trace->file);
		return;
	}
	snprintf(number, sizeof(number), "%u", trace->place);
	n = fprintf(trace->file, "%.4f %.3f %s %s > %s%s%s\n",
	            (double)(trace->begun_ns - trace->since_ns) / 1e9,
	            (double)(now_ns - trace->begun_ns) / 1e6,
	            trace->place < TRACE_NET ? number : places[trace->place - TRACE_NET],
	            trace->question.text, trace_result_text(result, text),
	            trace->answer.len ? " " : "", trace->answer.text);
	trace->left -= n > 0 ? (size_t)n : 0;
	trace->lines++;
	if (trace->progress)
		trace->progress(trace);
}

/* --- Replaying --- */

static int result_of(const char *answer, int most)
{
	size_t len = strcspn(answer, " ");
	long result = strtol(answer, NULL, 10);

	for (size_t i = 0; i < ERRORS && *answer == '!'; i++)
		if (strlen(errors[i].name) == len - 1 &&
		    memcmp(errors[i].name, answer + 1, len - 1) == 0)
			return -errors[i].err;
	return *answer == '!' || result < 0 || result > most ? -EIO : (int)result;
}

static unsigned place_of(const char *text)
{
	char *end;
	unsigned long number = strtoul(text, &end, 10);

	for (unsigned i = TRACE_NET; i < TRACE_PLACES; i++)
		if (strcmp(text, places[i - TRACE_NET]) == 0)
			return i;
	return end > text && !*end && number < TRACE_NET ? (unsigned)number : TRACE_PLACES;
}

bool trace_cut(char *text, struct trace_line *line)
{
	char *rest, *place, *arrow = strstr(text, " > ");

	if (*text == '#' || !arrow)
		return false;
	strtod(text, &rest);
	line->took_ms = strtod(rest, &rest);
	place = rest + strspn(rest, " ");
	rest = place + strcspn(place, " ");
	if (rest >= arrow)
		return false;
	*rest = *arrow = '\0';
	line->place = place_of(place);
	line->question = rest + 1;
	line->answer = arrow + 3;
	line->bytes = line->answer + strcspn(line->answer, " ");
	line->bytes += *line->bytes != '\0';
	return true;
}

/* Does the question go on with a transaction? Then what was before it counts. */
static bool goes_on(const char *question)
{
	static const char *const words[] = {"run - ", "slot ", "triplet", "path - "};

	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
		if (strncmp(question, words[i], strlen(words[i])) == 0)
			return true;
	return false;
}

/* FNV-1a. */
static uint64_t hash(uint64_t value, const char *text, size_t len)
{
	for (size_t i = 0; i < len; i++)
		value = (value ^ (uint8_t)text[i]) * UINT64_C(0x100000001b3);
	return value;
}

/* How often a driver of a DS2482 reads its status in a transaction is a matter of time. */
static uint64_t key_of(uint64_t ahead, const char *question)
{
	const char *last = strrchr(question, ' ');
	bool reads = strncmp(question, "transfer ", 9) == 0 && last[-1] == 'r';

	return hash(goes_on(question) ? ahead : 0, question,
	            reads ? (size_t)(last - question) : strlen(question));
}

int trace_read(struct trace *trace, const char *name, char *why, size_t why_size)
{
	size_t count = 1, number = 1;
	uint64_t next[TRACE_PLACES] = {0};
	char *rest, *text;
	int err = 0;

	trace->name = name;
	trace->text = rest = file_text(name, TRACE_MOST, &err, why, why_size);
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
	for (; (text = strsep(&rest, "\n")) && trace->lines < TRACE_LINES; number++) {
		struct trace_line *line = &trace->line[trace->lines];

		if (!trace_cut(text, line) || line->place == TRACE_PLACES)
			continue;
		if (!(line->took_ms >= 0 && line->took_ms < TOOK_MOST_MS))
			line->took_ms = TOOK_MOST_MS;
		line->number = number;
		line->key = key_of(next[line->place], line->question);
		line->next = hash(line->key, line->answer, strlen(line->answer));
		next[line->place] = line->next;
		trace->lines++;
		if (!trace->first[line->place])
			trace->first[line->place] = trace->lines;
	}
	return 0;
}

static bool is_link(const struct trace_line *line)
{
	return strncmp(line->question, "link ", 5) == 0;
}

unsigned trace_link_count(const struct trace *trace)
{
	unsigned n = 0;

	while (n < TRACE_NET && trace->first[n] && is_link(&trace->line[trace->first[n] - 1]))
		n++;
	return n;
}

/* Where devices differed, were the directions taken that are asked for now? */
static bool fits(const struct trace *trace, const struct trace_line *line)
{
	uint8_t taken[16] = {0};

	if (trace->direction_n == 1) {
		int bits = result_of(line->answer, 7);

		return bits < 0 || bits & 3 || bits >> 2 == trace->directions[0];
	}
	trace_parse(line->bytes, taken, sizeof(taken));
	for (size_t i = 0; i < trace->direction_n; i++)
		if ((taken[i] ^ trace->directions[i]) & taken[8 + i])
			return false;
	return true;
}

static const struct trace_line *next_of(const struct trace *trace)
{
	for (size_t i = trace->last[trace->place]; i < trace->lines; i++)
		if (trace->line[i].place == trace->place && !is_link(&trace->line[i]))
			return &trace->line[i];
	return NULL;
}

/* From the line given last on, and then from the beginning: a replay has no end. */
const struct trace_line *trace_find(struct trace *trace)
{
	const char *question = trace->question.text;
	const struct trace_line *expected = next_of(trace);
	size_t *last = &trace->last[trace->place];
	uint64_t key = key_of(trace->next[trace->place], question);

	for (size_t i = 0; i < trace->lines; i++) {
		size_t at = (*last + i) % trace->lines;
		const struct trace_line *line = &trace->line[at];

		if (line->place != trace->place || line->key != key || !fits(trace, line))
			continue;
		if (expected && line != expected)
			trace_note(trace, "%s:%zu: recorded is \"%.50s\", asked \"%.50s\"",
			           trace->name, expected->number, expected->question, question);
		*last = at + 1;
		trace->next[trace->place] = line->next;
		return line;
	}
	trace_note(trace, "%s: never asked in it: \"%.80s\"", trace->name, question);
	return NULL;
}

int trace_told(struct trace *trace, int most, int result, uint8_t *bytes, size_t *n)
{
	const struct trace_line *line;
	const struct bus_env *env = trace->env;

	if (trace->file) {
		if (*n)
			trace_bytes(&trace->answer, bytes, *n, trace->place == TRACE_BUS);
		trace_write(trace, result, bus_now(env));
		return result;
	}
	line = trace_find(trace);
	/* An answer may be shorter than what was asked for */
	if (*n)
		memset(bytes, 0xff, *n);
	*n = line ? trace_parse(line->bytes, bytes, *n) : 0;
	if (!line)
		return -EHOSTDOWN;
	if (env->wait(env->ctx, -1, 0, trace->begun_ns + (int64_t)(line->took_ms * NS_PER_MS)) ==
	    -ECANCELED)
		return -ECANCELED;
	return result_of(line->answer, most);
}
