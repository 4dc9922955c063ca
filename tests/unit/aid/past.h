/* SPDX-License-Identifier: MIT */
/*
 * A history in a folder of the test, written by a writer in virtual time and read by
 * libows-history.
 */
#pragma once

#include "src/history/file/writer.h"
#include "src/public/ows_history.h"

#define PAST_S INT64_C(1000000000)
#define PAST_DAY (86400 * PAST_S)
#define PAST_NOON (20000 * PAST_DAY + PAST_DAY / 2) /* wall clock minus boot time */
#define PAST_MOST 100000

enum { PAST_ROOM, PAST_LAMP, PAST_TITLE, PAST_COUNT };
extern const struct history_signal past_signals[PAST_COUNT]; /* double, bool, string */

struct past {
	char directory[300];
	struct history_options
		options; /* boot 1, a commit each 10 s; change it before past_begin() */
	struct history_writer *writer;
	char said[600]; /* what the writer said last */
};

/* Another folder; nothing is in it. */
void past_make(struct past *past);
/* A run begins: writer, table, begin. */
void past_begin(struct past *past, int64_t now_ns, int64_t offset_ns, bool trusted);
/* Values of the three signals. */
void past_room(struct past *past, int64_t time_ns, double value);
void past_lamp(struct past *past, int64_t time_ns, int64_t value);
void past_title(struct past *past, int64_t time_ns, const char *text);
void past_end(struct past *past, int64_t now_ns);
/* All items of a signal, in a place of past.c; how many. */
int past_items(struct past *past, int signal, struct ows_history_item **items);
/* A number that the file says to a question. */
int64_t past_ask(struct past *past, const char *text);
/* Pseudo-random numbers; the seed is 1 at the start of a program. */
unsigned past_random(unsigned below);
