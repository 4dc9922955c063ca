/* SPDX-License-Identifier: MIT */
/*
 * owsd-writer, the writer: owsd-web cannot write the configuration, and asks it. One request for
 * each connection to the socket NAME.config in the directory of owsd's files.
 */
#pragma once

#include "src/config/edit/tag.h"
#include "src/faces/web/problems.h"

#define WRITER_WORDS 512

enum writer_status {
	WRITER_DONE,
	WRITER_CONFLICT, /* the file is not that of base any more */
	WRITER_INVALID,  /* the text has errors */
	WRITER_REFUSED,  /* owsd-web may not, or asks for what cannot be */
	WRITER_ERROR,    /* reading or writing failed */
};

struct writer_order {
	const char *instance;
	const char *base;   /* a tag; "": there was no file */
	const char *person; /* for whom; has no control characters */
	const char *text;   /* the new file; NULL: put the file of before in place */
};

struct writer_answer {
	enum writer_status status;
	char tag[TAG_TEXT], backup[TAG_TEXT]; /* of the file, of the one of before; "": none */
	int64_t backup_ms;                    /* since 1970 */
	char reload[8];                       /* "done", "refused"; "none": owsd does not run */
	char why[WRITER_WORDS];               /* "": nothing to add */
	struct problems problems;
};

/*
 * Ask, and wait for the answer: for 70 s at most. 0 with an answer, whose problems are to be freed;
 * -ENOENT or -ECONNREFUSED: nobody listens there; -EINPROGRESS: it has the order, and no answer
 * came; -EPROTO: it is no answer; or another negative errno, and then the order did not arrive
 * whole.
 */
int writer_ask(const struct writer_order *order, struct writer_answer *answer);
/* Is there its socket? */
bool writer_is_there(const char *instance);
/* Read an answer of len bytes, with NUL behind them; the lines are cut. 0 or -EPROTO. Pure. */
int writer_parse(char *text, size_t len, struct writer_answer *answer);
/* Is that a tag, or ""? */
bool writer_is_tag(const char *text);
/* How the writer is started, for a message. */
void writer_remedy(const char *instance, char text[WRITER_WORDS]);
