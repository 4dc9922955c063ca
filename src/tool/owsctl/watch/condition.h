/* SPDX-License-Identifier: MIT */
/* What `owsctl wait` waits for: a comparison of a value. */
#pragma once

#include "src/faces/show/reading.h"

struct condition {
	int op; /* by condition_op() */
	const char *text;
	bool has_integer; /* the number is whole, and exact in integer */
	int64_t integer;
	double number;
};

/* The number of the operator "=" "==" "!=" "<" "<=" ">" ">="; -1: the text is none of them. */
int condition_op(const char *text);
/*
 * Make a condition for values of that type. Numbers as in `owsctl set`, but without the limits of
 * the type; bool also on/off and the like. -EINVAL: the text is no number; -EOPNOTSUPP: strings
 * have only = and !=.
 */
int condition_make(enum ows_type type, const char *op, const char *text,
                   struct condition *condition);
bool condition_holds(const struct condition *condition, const struct reading *reading);
