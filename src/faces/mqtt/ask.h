/* SPDX-License-Identifier: MIT */
/* What a message asks for: a value, as text or in JSON; and the answer to it. Pure functions. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "src/faces/kit/body.h"
#include "src/faces/show/json.h"

#define ASK_MOST 1024 /* bytes of a message */

struct ask {
	const char *value; /* what is to be set; "": nothing; NULL: no value was asked for */
	const struct body_member *id; /* what the sender calls it; NULL: nothing */
	struct body body;
	char text[ASK_MOST + 1];
};

/*
 * Read a message: {"v":21.5,"id":7}, v and id a text, a number or a flag; what does not begin as an
 * object is the value itself. plain: any text is. NULL, or what is wrong with it.
 */
const char *ask_read(struct ask *ask, const char *text, size_t len, bool plain);
/* The member id, if the sender gave one. */
void ask_id_json(struct json *json, const struct ask *ask);
/* The members of an answer: what was asked for, and why it was refused; why NULL: it was taken. */
void ask_answer_json(struct json *json, const struct ask *ask, const char *why);
