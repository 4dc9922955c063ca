/* SPDX-License-Identifier: MIT */
/*
 * A recording of a bus: each call of its links, each exchange of its connection and each of its
 * answers is a line of text. A bus can be opened on such a file in place of a wire. owsctl(1) has
 * the format.
 *
 * A line is a question and its answer. The same functions stand in front of a link, where they
 * write down what it answers, and in place of it, where they look the answer up.
 *
 *   tap.c        a recording, or a replay, is begun and ended
 *   links.c      the calls of links
 *   i2c.c        the transactions of an I2C adapter
 *   frames.c     the exchanges of connections, the answers of a bus
 *   trace.c      lines: written, read, looked up
 *   anonymous.c  other ids in place of those of a recording
 *
 * Room hal/trace: recordings of buses: written, made anonymous, answered from.
 */
#pragma once

#include <stdio.h>

#include "hal/bus/tap.h"

#define TRACE_BEGIN "owsd trace 1\n"
#define TRACE_MOST (4u << 20) /* bytes of a file */
#define TRACE_LINES 65536     /* ... and what is read of it */

struct trace_text {
	char *text; /* NULL: empty */
	size_t len, room;
};

/* The lines of one link, connection or bus. */
struct trace_place {
	char name[8]; /* the number of a link, "net", "bus" */
	bool quotes;  /* its bytes are mostly text */
	bool told;    /* replay: last is a line */
	size_t last;  /* ... that was given last */
	/* Of a search: what is taken where devices differ; 8 bytes, or 1 of a triplet. */
	const uint8_t *directions;
	size_t direction_n;
};

struct trace_line {
	const char *place, *question, *answer;
	double took_ms;
	size_t number;  /* in the file, from 1 on */
	size_t before;  /* the line ahead of it of the same place, + 1; 0: none */
	uint64_t chain; /* its question and answer, and those ahead in its transaction */
};

struct trace_link;
struct trace {
	struct tap tap; /* first */
	FILE *file;     /* where it is recorded; NULL: it is replayed */
	size_t left;    /* bytes that may still be written */
	unsigned lines; /* written; replay: how many there are */
	void (*progress)(const struct trace *trace); /* after each; NULL: nobody looks */
	int64_t since_ns, begun_ns;
	struct trace_text question, answer;
	struct trace_link *links;
	struct trace_place net, i2c, bus;
	uint8_t *in; /* what came over the connection */
	size_t in_n;
	int64_t ended_ns; /* when that was; 0: nothing came */
	bool asked;       /* an exchange is under way */
	/* Replay. */
	const char *name; /* of the file */
	char *text;
	struct trace_line *line;
	unsigned notes;
	int peer; /* the other end of what connect() gave; -1 */
};

/* Read the lines of a file. 0, -ENOMEM, or -EINVAL with the reason in why. */
int trace_read(struct trace *trace, const char *name, char *why, size_t why_size);
/* Is there a line of this place, as "net"? */
bool trace_has(const struct trace *trace, const char *place);
/* Free the lines and the texts. */
void trace_free(struct trace *trace);
/* Are lines left out, since the file would be too long? */
bool trace_full(const struct trace *trace);

/* Begins a question; more text may follow. */
void trace_ask(struct trace *trace, const struct bus_env *env, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
void trace_add(struct trace_text *text, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
/* As hexadecimal digits, "-" if there are none; quoted: as text. */
void trace_bytes(struct trace_text *text, const uint8_t *bytes, size_t n, bool quoted);
/* Reads what trace_bytes() wrote, n bytes at most: how many there are. */
size_t trace_parse(const char *text, uint8_t *bytes, size_t n);
void trace_result_text(struct trace_text *text, int result, const uint8_t *bytes, size_t n,
                       bool quoted);
/*
 * The answer to the question: recorded, or looked up, after the time that it took. Returns result,
 * or what is recorded as that; *n is the room in bytes, and gets their count then. -EHOSTDOWN: it
 * was never asked.
 */
int trace_told(struct trace *trace, const struct bus_env *env, struct trace_place *place,
               int result, uint8_t *bytes, size_t *n);
/* Replay: the next line with the question, which ends the time there is. NULL: none has it. */
const struct trace_line *trace_find(struct trace *trace, const struct bus_env *env,
                                    struct trace_place *place);
int trace_result(const char *answer);
/* Tells the host of a replay something about it; after some it is silent. */
void trace_note(struct trace *trace, const struct bus_env *env, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
