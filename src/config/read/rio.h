/* SPDX-License-Identifier: MIT */
/*
 * The .rio document: the text of a file and a tree over it. Every node knows which bytes of the
 * text it is made of, so an edit replaces these bytes and nothing else: comments, order, blank
 * lines, line ends and the spelling of numbers stay as they were.
 *
 *     OwsDrv {
 *       Timeout 20                     a word
 *       TargetName "localhost:4304"    a string; adjacent strings are one, as in C
 *       Example [ 0 0 0 ]              a list
 *       # a comment, to the end of the line
 *       Item { Name "room1" }          a block
 *     }
 *
 * In strings \" and \\ stand for the second character; other backslashes for themselves. LF, CRLF
 * and CR end a line, also mixed.
 */
#pragma once

#include "src/config/read/arena.h"
#include "src/config/read/report.h"

#define RIO_FILE_MAX (16u * 1024 * 1024)
#define RIO_DEPTH_MAX 16
#define RIO_KEY_MAX 63
#define RIO_VALUE_MAX 4096 /* bytes of a word or of a string after joining */

enum rio_kind {
	RIO_WORD,
	RIO_STRING,
	RIO_LIST,
	RIO_BLOCK,
};

struct rio_node {
	enum rio_kind kind;
	bool broken;       /* the block has a syntax error: a missing key may have been there */
	const char *key;   /* "" for the document itself */
	const char *value; /* word, string: NUL-terminated; list: as written; block: "" */
	struct rio_position at, value_at;
	size_t begin, end;             /* bytes of the text, from the key to the end of the value */
	size_t value_begin, value_end; /* blocks: the byte after "{", and that of "}" */
	struct rio_node *parent, *first, *last, *next;
};

struct rio {
	struct arena arena;
	const char *text;
	size_t len;
	const char *line_end; /* "\n", "\r\n" or "\r", as in the first line */
	struct rio_node root;
};

/*
 * Read len bytes of text, which is copied; file is for messages and has to live as long. Returns 0
 * also when there were syntax errors: then report->errors grew and what could be read is there.
 * -EFBIG the text is longer than RIO_FILE_MAX (reported); -ENOMEM. Free with rio_free().
 */
int rio_parse(const char *file, const char *text, size_t len, struct config_report *report,
              struct rio **rio);
void rio_free(struct rio *rio);

/* Bytes of the line end that stands at p, which is before end: 2, 1, or 0 when there is none. */
size_t rio_line_end_length(const char *p, const char *end);

/* The first child with that key, or NULL; rio_next: the next one with the same key. */
struct rio_node *rio_child(const struct rio_node *block, const char *key);
struct rio_node *rio_next(const struct rio_node *node);
