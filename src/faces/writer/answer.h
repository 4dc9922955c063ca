/* SPDX-License-Identifier: MIT */
/*
 * The writer's answer: lines "key: value", of which only those stand there that apply, and an empty
 * line.
 *
 *     status: done
 *     tag: 51c07c8e6a2f9d03
 *     reload: refused
 *     backup: 9f3a00c417d2e5b1 1764000000000
 *     why: Listen, ListenSocket, ListenAllow and ListenReadOnly change by a restart only
 *     problem: W 12 3 the item has no Unit
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "src/config/edit/tag.h"

enum answer_status {
	ANSWER_DONE,     /* the file is the new one */
	ANSWER_CONFLICT, /* the file is not that of base */
	ANSWER_INVALID,  /* the text has errors: problems */
	ANSWER_REFUSED,  /* the peer may not, or asks for what cannot be */
	ANSWER_ERROR,    /* reading or writing failed */
};
enum answer_reload {
	ANSWER_NOT_ASKED,
	ANSWER_RELOADED,
	ANSWER_RELOAD_REFUSED,
	ANSWER_NO_OWSD,
};

#define ANSWER_WHY 512

struct answer {
	enum answer_status status;
	bool has_tag;
	char tag[TAG_TEXT]; /* of the file as it is on disk; "": there is none */
	enum answer_reload reload;
	char backup[TAG_TEXT]; /* of the file of before; "": there is none */
	int64_t backup_ms;     /* when it was kept, ms since 1970 */
	char why[ANSWER_WHY];
	char *problems; /* lines; NULL: none */
	size_t problems_len;
	FILE *out; /* that writes them */
};

/* Set status and why, which is made one printable line. */
void answer_say(struct answer *answer, enum answer_status status, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
void answer_problem(struct answer *answer, bool is_error, int line, int column, const char *text);
/* The whole as a text (malloc); NULL: no memory. */
char *answer_print(struct answer *answer, size_t *len);
void answer_free(struct answer *answer);
/* The word of a status, for the log. */
const char *answer_word(enum answer_status status);
