/* SPDX-License-Identifier: MIT */
/*
 * A recording of a bus: each call of its links, each exchange of its connection and each of its
 * answers is a line of text. A bus can be opened on such a file in place of a wire. owsctl(1) has
 * the format.
 *
 * A line is a question and its answer. The same functions stand in front of a link, where they
 * write down what it answers, and in place of it, where they look the answer up.
 *
 *   tap.c        a recording, or a replay; the exchanges of connections, the answers of a bus
 *   links.c      the calls of links
 *   i2c.c        the transactions of an I2C adapter
 *   trace.c      lines: written, read, looked up
 *   anonymous.c  other ids in place of those of a recording
 *
 * Room hal/trace: recordings of buses: written, made anonymous, answered from.
 */
#pragma once

#include <stdio.h>

#include "hal/bus/tap.h"

#define TRACE_BEGIN "owsd trace 1\n"
#define TRACE_MOST (4u << 20)       /* bytes of a file; a recording has half of that at most */
#define TRACE_LINES 65536           /* ... and what is read of it */
#define TRACE_TEXT (TRACE_MOST / 8) /* bytes of a question or an answer, with NUL */

/* Where a line was: the number of a link, or one of these. */
enum trace_place { TRACE_NET = 64, TRACE_I2C, TRACE_BUS, TRACE_PLACES };

/* What it has no room for is cut. */
struct trace_text {
	size_t len;
	char text[TRACE_TEXT];
};

struct trace_line {
	unsigned place;
	char *question, *answer, *bytes; /* bytes: of the answer */
	double took_ms;
	size_t number; /* in the file, from 1 on */
	uint64_t key;  /* its question, and what is ahead of it in its transaction */
	uint64_t next; /* ... with its answer */
};

struct trace_link;
struct trace {
	struct tap tap; /* first */
	FILE *file;     /* where it is recorded; NULL: it is replayed */
	size_t left;    /* bytes that may still be written; 0: lines are left out */
	unsigned lines; /* written; replay: how many there are */
	void (*progress)(const struct trace *trace); /* after each; NULL: nobody looks */
	struct trace_link *links;
	/* The question, and what is known of its answer. */
	struct trace_text question, answer;
	const struct bus_env *env;
	unsigned place;
	int64_t since_ns, begun_ns;
	int64_t ended_ns; /* of an exchange: when the last bytes came */
	bool asked;       /* an exchange is under way */
	/* Of a search: what is taken where devices differ; 8 bytes, or 1 of a triplet. */
	uint8_t directions[8];
	size_t direction_n;
	/* Replay. */
	const char *name; /* of the file */
	char *text;
	struct trace_line *line;
	/* Of each place the first line, and the one that was given last; + 1, 0: none. */
	size_t first[TRACE_PLACES], last[TRACE_PLACES];
	uint64_t next[TRACE_PLACES]; /* of the last line */
	unsigned notes;
	int peer; /* the other end of what connect() gave; -1 */
};

/* Read the lines of a file. 0, -ENOMEM, or -EINVAL with the reason in why. */
int trace_read(struct trace *trace, const char *name, char *why, size_t why_size);
/* Cut a line into its parts by two NUL in place of blanks. False: it has none, nothing is done. */
bool trace_cut(char *text, struct trace_line *line);
/* How many links are recorded. */
unsigned trace_link_count(const struct trace *trace);

void trace_add(struct trace_text *text, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
/*
 * As hexadecimal digits, "-" if there are none; quoted: as text, which goes on with what is quoted
 * at the end.
 */
void trace_bytes(struct trace_text *text, const uint8_t *bytes, size_t n, bool quoted);
/* Reads what trace_bytes() wrote, n bytes at most: how many there are. */
size_t trace_parse(const char *text, uint8_t *bytes, size_t n);
#define TRACE_RESULT 20
/* A number, or the name of an error. */
const char *trace_result_text(int result, char text[TRACE_RESULT]);

/* Begins a question; more text may follow. */
void trace_ask(struct trace *trace, const struct bus_env *env, unsigned place, const char *format,
               ...) __attribute__((format(printf, 4, 5)));
/* A recording: the line of the question, whose answer came at that time. */
void trace_write(struct trace *trace, int result, int64_t now_ns);
/*
 * The answer to the question: recorded, or looked up, after the time that it took. Returns result,
 * or what is recorded as that: an error, or 0 to most. *n is the room in bytes, and gets their
 * count then. -EHOSTDOWN: it was never asked.
 */
int trace_told(struct trace *trace, int most, int result, uint8_t *bytes, size_t *n);
/* Replay: the next line with the question, which ends the time there is. NULL: none has it. */
const struct trace_line *trace_find(struct trace *trace);
/* Tells the host of a replay something about it; after some it is silent. */
void trace_note(struct trace *trace, const char *format, ...) __attribute__((format(printf, 2, 3)));
