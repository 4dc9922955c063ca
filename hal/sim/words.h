/* SPDX-License-Identifier: MIT */
/* The words of a line of the scenario language. The first error stays; after it nothing is read. */
#ifndef HAL_SIM_WORDS_H
#define HAL_SIM_WORDS_H

#include <stdbool.h>

#include "hal/sim/slave.h"

struct words {
	const char *file;
	unsigned line;
	const char *text,
		*next;   /* the whole line, and what is not read yet; ended by NUL or '\n' */
	char word[64];   /* the last one read */
	unsigned column; /* its column, from 1 */
	char *why;
	size_t why_size;
	bool failed;
};

void words_init(struct words *words, const char *file, unsigned line, const char *text, char *why,
                size_t why_size);
/* The next word into words->word; false at the end of the line, where '#' begins, or failed. */
bool words_next(struct words *words);
/* Is the next word this one? Then it is read. */
bool words_take(struct words *words, const char *word);
/* "file:line:column: text", the column being that of the last word. */
__attribute__((format(printf, 2, 3))) void words_fail(struct words *words, const char *format, ...);
/* Nothing more may come. */
void words_end(struct words *words);

/* Each reads one word; what says in the error what was expected. */
double words_number(struct words *words, const char *what, double least, double most);
int64_t words_time(struct words *words, const char *what); /* "90s", "1.5h", in ns */
/* What the input does; every value of it is one that the input can have. */
struct sim_curve words_curve(struct words *words, const struct sim_input *input);

#endif
