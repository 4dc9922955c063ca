/* SPDX-License-Identifier: MIT */
/*
 * The head of a request to the writer, which ends with an empty line:
 *
 *     owsd-writer 1
 *     do: replace
 *     base: 9f3a00c417d2e5b1
 *     for: anna
 *     length: 1234
 */
#pragma once

#include <stddef.h>

#include "src/config/edit/tag.h"

#define ORDER_HEAD_MAX 1024 /* bytes of a head, with the empty line */
#define ORDER_PERSON 64

enum order_kind {
	ORDER_REPLACE, /* length bytes follow: the new file */
	ORDER_RESTORE, /* put the file of before in place */
	ORDER_RENAME,  /* length bytes follow: the name of an item, a line end, its new name */
};

struct order {
	enum order_kind kind;
	char base[TAG_TEXT];       /* of the file that the request is made for; "": there is none */
	char person[ORDER_PERSON]; /* for whom, a claim; printable; "": not named */
	size_t length;
};

/*
 * Pure. Returns the bytes that the head has; 0: it is not whole yet; -EINVAL: what was sent is no
 * head, whatever follows, and why says what is wrong.
 */
int order_parse(const char *text, size_t len, struct order *order, const char **why);
