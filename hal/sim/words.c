/* SPDX-License-Identifier: MIT */
/* Parses the words of a scenario's line: names, numbers, times and curves. */
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/sim/words.h"

#define MAX_TIME_S 1e9

void words_init(struct words *words, const char *file, unsigned line, const char *text, char *why,
                size_t why_size)
{
	*words = (struct words){.file = file,
	                        .line = line,
	                        .text = text,
	                        .next = text,
	                        .column = 1,
	                        .why = why,
	                        .why_size = why_size};
}

void words_fail(struct words *words, const char *format, ...)
{
	va_list args;
	int used;

	if (words->failed)
		return;
	words->failed = true;
	used = words->line ? snprintf(words->why, words->why_size, "%s:%u:%u: ", words->file,
	                              words->line, words->column)
	                   : snprintf(words->why, words->why_size, "%s: ", words->file);
	if (used < 0 || (size_t)used >= words->why_size)
		return;
	va_start(args, format);
	vsnprintf(words->why + used, words->why_size - (size_t)used, format, args);
	va_end(args);
}

static const char *skip_blanks(const char *text)
{
	while (*text == ' ' || *text == '\t' || *text == '\r')
		text++;
	return text;
}

static size_t word_length(const char *text)
{
	return strcspn(text, " \t\r\n#");
}

bool words_next(struct words *words)
{
	const char *word = skip_blanks(words->next);
	size_t len = word_length(word);

	words->column = (unsigned)(word - words->text) + 1;
	words->word[0] = '\0';
	if (len == 0 || words->failed)
		return false;
	if (len >= sizeof(words->word)) {
		words_fail(words, "this word is longer than %zu characters",
		           sizeof(words->word) - 1);
		return false;
	}
	memcpy(words->word, word, len);
	words->word[len] = '\0';
	words->next = word + len;
	return true;
}

/* The column of an error is that of the last word, so a word that is not taken is not counted. */
bool words_take(struct words *words, const char *word)
{
	const char *next = skip_blanks(words->next);
	size_t len = word_length(next);

	if (len != strlen(word) || memcmp(next, word, len) != 0)
		return false;
	return words_next(words);
}

/* Does the next word begin as a number does? The word stays unread. */
static bool words_number_ahead(const struct words *words)
{
	const char *next = skip_blanks(words->next);

	return isdigit((unsigned char)*next) || *next == '-' || *next == '+' || *next == '.';
}

void words_end(struct words *words)
{
	if (words_next(words))
		words_fail(words, "\"%s\" is too much here", words->word);
}

/* Parse the number at the beginning of the word, in the same way in every locale. */
static double parse_decimal(const char *word, const char **end)
{
	double value = 0, scale = 1;
	bool negative = *word == '-', any = false;

	if (*word == '-' || *word == '+')
		word++;
	for (; isdigit((unsigned char)*word); word++, any = true)
		value = value * 10 + (*word - '0');
	if (*word == '.') {
		for (word++; isdigit((unsigned char)*word); word++, any = true) {
			scale /= 10;
			value += scale * (*word - '0');
		}
	}
	*end = any ? word : NULL;
	return negative ? -value : value;
}

double words_number(struct words *words, const char *what, double least, double most)
{
	const char *end = NULL;
	double value;

	if (!words_next(words)) {
		words_fail(words, "expected %s", what);
		return least;
	}
	if (strncmp(words->word, "0x", 2) == 0) {
		char *stop;

		value = (double)strtoul(words->word + 2, &stop, 16);
		end = words->word[2] ? stop : NULL;
	} else {
		value = parse_decimal(words->word, &end);
	}
	if (!end || *end)
		words_fail(words, "\"%s\": expected %s, a number", words->word, what);
	else if (value < least || value > most)
		words_fail(words, "%s: %s goes from %.10g to %.10g", words->word, what, least,
		           most);
	else
		return value;
	return least;
}

static double unit_seconds(const char *unit)
{
	static const struct {
		const char *name;
		double seconds;
	} units[] = {{"us", 1e-6}, {"ms", 1e-3}, {"s", 1},          {"m", 60},
	             {"h", 3600},  {"d", 86400}, {"w", 7 * 86400.0}};

	for (size_t i = 0; i < sizeof(units) / sizeof(units[0]); i++) {
		if (strcmp(unit, units[i].name) == 0)
			return units[i].seconds;
	}
	return 0;
}

static bool parse_time(const char *word, int64_t *ns)
{
	const char *end;
	double value = parse_decimal(word, &end), unit = end ? unit_seconds(end) : 0;

	if (end && !*end && value == 0)
		unit = 1;
	if (unit <= 0 || value < 0 || value * unit > MAX_TIME_S)
		return false;
	*ns = sim_round(value * unit * 1e9);
	return true;
}

int64_t words_time(struct words *words, const char *what)
{
	int64_t ns = 0;

	if (!words_next(words))
		words_fail(words, "expected %s, as 90s or 1.5h", what);
	else if (!parse_time(words->word, &ns))
		words_fail(words, "\"%s\": expected %s, as 500ms, 90s, 5m, 1.5h or 2d", words->word,
		           what);
	return ns;
}

static int64_t parse_period(struct words *words)
{
	int64_t ns = words_time(words, "the period");

	if (!words->failed && ns < 1000)
		words_fail(words, "the period is 1us at least");
	return ns;
}

static void words_check(struct words *words, const struct sim_input *input, double value)
{
	bool bounded = input->least < input->most;

	if (input->pin && value != 0 && value != 1)
		words_fail(words, "%g: %s is 0 or 1", value, input->name);
	else if (bounded && (value < input->least || value > input->most))
		words_fail(words, "%.10g: %s goes from %.10g to %.10g", value, input->name,
		           input->least, input->most);
}

/* Steps end at the first word that is no number, which belongs to what follows the curve. */
static void parse_steps(struct words *words, const struct sim_input *input, struct sim_curve *curve)
{
	while (words_number_ahead(words) && words_next(words)) {
		struct sim_step *step = &curve->step[curve->steps];
		char *colon = strchr(words->word, ':');
		const char *end = NULL;

		if (colon) {
			*colon = '\0';
			step->value = parse_decimal(colon + 1, &end);
		}
		if (curve->steps == SIM_MAX_STEPS) {
			words_fail(words, "%d steps are the most", SIM_MAX_STEPS);
			return;
		}
		if (!end || *end || !parse_time(words->word, &step->at_ns)) {
			words_fail(words, "expected a step, as 10m:25.5");
			return;
		}
		if (curve->steps ? step->at_ns <= step[-1].at_ns : step->at_ns != 0) {
			words_fail(words, "steps begin at 0 and go up in time");
			return;
		}
		words_check(words, input, step->value);
		curve->steps++;
	}
	if (curve->steps == 0) {
		words_next(words);
		words_fail(words, "expected a step, as 0:20");
	} else if (words_take(words, "repeat")) {
		curve->span_ns = parse_period(words);
		if (!words->failed && curve->span_ns <= curve->step[curve->steps - 1].at_ns)
			words_fail(words, "the steps are longer than that");
	}
}

struct sim_curve words_curve(struct words *words, const struct sim_input *input)
{
	static const struct {
		const char *name;
		enum sim_shape shape;
	} shapes[] = {{"constant", SIM_CONSTANT},
	              {"ramp", SIM_RAMP},
	              {"sine", SIM_SINE},
	              {"square", SIM_SQUARE},
	              {"steps", SIM_STEPS}};
	struct sim_curve curve = {.shape = SIM_CONSTANT};
	size_t i = 0;

	if (!words_number_ahead(words)) {
		words_next(words);
		while (i < 5 && strcmp(words->word, shapes[i].name) != 0)
			i++;
		if (i == 5) {
			words_fail(words,
			           "\"%s\": expected a value, or constant, ramp, sine, "
			           "square, steps",
			           words->word);
			return curve;
		}
		curve.shape = shapes[i].shape;
		if (input->pin && (curve.shape == SIM_RAMP || curve.shape == SIM_SINE))
			words_fail(words, "\"%s\": %s is 0 or 1: expected square or steps",
			           words->word, input->name);
	}
	if (curve.shape == SIM_STEPS) {
		parse_steps(words, input, &curve);
		return curve;
	}
	curve.a = words_number(words, "a value", -1e9, 1e9);
	words_check(words, input, curve.a);
	if (curve.shape != SIM_CONSTANT) {
		curve.b = words_number(words, "a value", -1e9, 1e9);
		words_check(words, input, curve.shape == SIM_SINE ? curve.a - curve.b : curve.b);
		words_check(words, input, curve.shape == SIM_SINE ? curve.a + curve.b : curve.b);
		curve.span_ns = parse_period(words);
	}
	return curve;
}
