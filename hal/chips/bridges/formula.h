/* SPDX-License-Identifier: MIT */
/*
 * Formulas over the bytes of a sensor: numbers, + - * / and parentheses, fields of bytes (u8, s16le
 * and so on), names of earlier formulas, and a few functions. They are parsed once into a list of
 * operations, whose places and depth are checked then: evaluation cannot fail, but may give what is
 * no number.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FORMULA_DEPTH 16
#define FORMULA_NAME 24

struct formula_op {
	uint8_t code;
	double number; /* a constant; where a field begins; which name */
};

/* The operations of all formulas of a table, one after the other. */
struct formula_pool {
	struct formula_op *ops;
	unsigned count, room;
};

struct formula {
	unsigned first, count;
};

/* What a formula may speak of. */
struct formula_scope {
	unsigned bytes; /* that were read before */
	const char (*names)[FORMULA_NAME];
	unsigned name_count;
	bool set; /* may it use $, the value that is to be written? */
};

struct formula_input {
	const uint8_t *bytes;
	const double *names;
	double set;
};

/*
 * Parse what stands at *text, and move *text behind it: the longest formula. 0, -ENOMEM, or -EINVAL
 * with the reason in why.
 */
int formula_parse(struct formula_pool *pool, const struct formula_scope *scope, const char **text,
                  struct formula *formula, char *why, size_t why_size);
double formula_value(const struct formula_pool *pool, struct formula formula,
                     const struct formula_input *input);
/* False: a constant that is no byte. */
bool formula_is_byte(const struct formula_pool *pool, struct formula formula);
