/* SPDX-License-Identifier: MIT */
/*
 * The body of a POST, or the summary of another page: one JSON object of texts, numbers and flags,
 * and nothing deeper.
 */
#pragma once

#include <stddef.h>

#define BODY_MEMBERS 16

enum body_kind {
	BODY_NULL,
	BODY_STRING,
	BODY_NUMBER,
	BODY_TRUE,
	BODY_FALSE,
};
struct body_member {
	const char *key;
	enum body_kind kind;
	const char *text; /* of a string without escapes; of a number as it stands; "true" */
};
struct body {
	unsigned count;
	struct body_member members[BODY_MEMBERS];
};

/*
 * Read len bytes, which become the strings that the members point to: they are changed, and have to
 * live as long. 0; -EINVAL: it is no such object; -E2BIG: it has too many members. Pure.
 */
int body_parse(char *text, size_t len, struct body *body);
/* NULL: there is none of that name. */
const struct body_member *body_find(const struct body *body, const char *key);
/* The string of that name; "" if there is none, or if it is none. */
const char *body_string(const struct body *body, const char *key);
