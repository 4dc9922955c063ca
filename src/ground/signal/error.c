/* SPDX-License-Identifier: MIT */
/* The words for the error of a request, and the remedy: one table for the log and for owsctl. */
#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "src/ground/signal/error.h"

static const struct {
	int err;
	const char *text, *remedy;
} errors[] = {
	{0, "no error", ""},
#define ERROR(err, word, remedy) {err, word, remedy},
#define QUALITY(code, health, word, cause, remedy)
#define ALARM(kind, event, word, cause, remedy)
#include "src/ground/signal/words_list.h"
#undef ALARM
#undef QUALITY
#undef ERROR
};
#define ERRORS (sizeof(errors) / sizeof(errors[0]))

static size_t error_find(int err)
{
	size_t i = 0;

	while (i < ERRORS && errors[i].err != -err)
		i++;
	return i;
}

const char *error_text(int err)
{
	size_t i = error_find(err);

	return i < ERRORS ? errors[i].text : strerror(-err);
}

const char *error_remedy(int err)
{
	size_t i = error_find(err);

	return i < ERRORS ? errors[i].remedy : "";
}

const char *error_answer_text(int err, double number, char words[ERROR_WORDS])
{
	if (err != -EDOM)
		return error_text(err);
	snprintf(words, ERROR_WORDS, "%s: %.6g", error_text(err), number);
	return words;
}

const char *error_answer_words(int err, double number, char words[ERROR_WORDS])
{
	if (err != -EDOM)
		return error_words(err, words);
	snprintf(words, ERROR_WORDS, "%s: %.6g: look at the sensor and its supply", error_text(err),
	         number);
	return words;
}

const char *error_words(int err, char words[ERROR_WORDS])
{
	const char *remedy = error_remedy(err);

	snprintf(words, ERROR_WORDS, "%s%s%s", error_text(err), *remedy ? ": " : "", remedy);
	return words;
}
