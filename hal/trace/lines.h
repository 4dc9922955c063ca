/* SPDX-License-Identifier: MIT */
/*
 * The lines of a recording. The same calls write a new one, and look up one that is there.
 * owsctl(1) has their form. The questions:
 *
 * link: the number of the chip, and which of the questions the link knows
 * run r, run -: with a reset or without; bytes written, how many are read; strong: the pull-up
 * path, slot: all of a search, with a reset (r) or without, answered with the id, and the id with
 *   all bits turned where devices differ; one bit
 * search, verify, recover: all devices; is this one there; a rung of the recovery
 * transfer, write, read, claim: of an I2C adapter, with the address: messages that write (w) bytes
 *   or read (r) so many (of the last the bytes are counted); SMBus calls; is the address free
 * has, offers, area, write, convert: of a driver of the kernel (target w1)
 */
#pragma once

#include "hal/trace/recording.h"
#include "hal/wire/link.h"

/* Where a line was: a link, a connection, an adapter or a bus. */
struct place {
	char name[4];
	const char *last; /* replay: behind the line that was given last; NULL: none was */
};

/*
 * Bytes as hexadecimal digits, "-" if there are none; in quotes what can be printed; or ids of 8
 * bytes, with the dot that anonymous.c looks for.
 */
enum trace_form { TRACE_HEX, TRACE_TEXT, TRACE_IDS };

struct lines;
struct trace_link {
	struct link link; /* first */
	struct link_ops ops;
	struct link_facts facts;
	struct link *under; /* NULL: it is replayed */
	struct lines *lines;
	struct place place;
};

struct lines {
	struct trace trace; /* first */
	FILE *file;         /* that an anonymous recording becomes; NULL: it is none */
	/* Place and question, and after a NUL the bytes of the answer. */
	FILE *now;
	char *text;
	size_t len;
	const struct bus_env *env;
	struct place *place;
	int64_t begun_ns, ended_ns; /* ended: of an exchange, when the last bytes came */
	bool asked;                 /* an exchange is under way */
	enum trace_form form;       /* of the answer */
	const uint8_t *directions;  /* of a search: what is taken where devices differ; NULL */
	struct place net, i2c, bus;
	char *whole; /* the text of a replay, or of an anonymous recording */
	size_t whole_len;
	struct trace_link link[TRACE_LINKS];
	/* Replay. */
	const char *name; /* of the file */
	double took_ms;   /* of the line that was found */
	unsigned notes;
	int peer; /* the other end of what connect() gave; -1 */
};

/* Begins a question, whose text the caller writes there. */
FILE *trace_ask(struct lines *lines, const struct bus_env *env, struct place *place);
/* Ends the question; bytes of the answer follow. */
const char *trace_asked(struct lines *lines);
void trace_more(struct lines *lines, const uint8_t *bytes, size_t n);
/* Ends the answer, and returns its text; the result is a number that is not 0, or an error. */
const char *trace_result(struct lines *lines, int result);
void trace_bytes(FILE *file, const uint8_t *bytes, size_t n, enum trace_form form);
/* Reads what trace_bytes() wrote, once or several times, n bytes at most: how many there are. */
size_t trace_parse(const char *text, uint8_t *bytes, size_t n);
/* A recording: the line of the question and the answer, which came at that time. */
void trace_write(struct lines *lines, int result, int64_t now_ns);
/*
 * The answer to the question: recorded, or looked up, after the time that it took. Returns result,
 * or what is recorded as that: an error, or 0 to most. *n is the room in bytes, and gets their
 * count then. -EHOSTDOWN: it was never asked.
 */
int trace_told(struct lines *lines, int most, int result, uint8_t *bytes, size_t *n);
/* Replay: the answer of the next line with the question; NULL: none has it. */
const char *trace_find(struct lines *lines);
/* Replay: passes the time that this answer took. Returns its result, as trace_told(). */
int trace_pass(struct lines *lines, const char *answer, int most);
/* Tells the host of a replay something about the line at `at`; after some it is silent. */
void trace_note(struct lines *lines, const char *at, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
/* How much of a text, up to a letter, such a message shows. */
int trace_shown(const char *text, const char *end);
