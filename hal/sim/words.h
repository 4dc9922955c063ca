/* SPDX-License-Identifier: MIT */
/*
 * Parses the words of a line of the scenario language. The first error stays; after it no word is
 * read.
 */
#pragma once

#include <stdbool.h>

#include "hal/sim/slave.h"

struct words {
	const char *file;
	unsigned line;
	const char *text, *next; /* the whole line, and its unread part; NUL or '\n' ends both */
	char word[64];           /* the last word */
	unsigned column;         /* the column of the last word, from 1 */
	char *why;
	size_t why_size;
	bool failed;
};

void words_init(struct words *words, const char *file, unsigned line, const char *text, char *why,
                size_t why_size);
/* Read the next word into words->word; false: at the end of the line, at '#', or after an error. */
bool words_next(struct words *words);
/* Read the next word if it is this one. */
bool words_take(struct words *words, const char *word);
/* Report an error as "file:line:column: text"; the column is that of the last word. */
__attribute__((format(printf, 2, 3))) void words_fail(struct words *words, const char *format, ...);
/* Report an error if the line has another word. */
void words_end(struct words *words);

/* Each function reads one word; `what` names in the error what was expected. */
double words_number(struct words *words, const char *what, double least, double most);
int64_t words_time(struct words *words, const char *what); /* "90s", "1.5h", in ns */
/* Read a curve; each of its values is one that the input can have. */
struct sim_curve words_curve(struct words *words, const struct sim_input *input);
