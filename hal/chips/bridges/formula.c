/* SPDX-License-Identifier: MIT */
/* Formulas: parsed by recursive descent into operations on a stack of numbers. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/bridges/formula.h"

enum code {
	NUMBER,
	SET,
	NAME,
	ADD,
	SUBTRACT,
	MULTIPLY,
	DIVIDE,
	NEGATE,
	BITS,
	LEAST,
	MOST,
	FLOOR,
	POWER,
	FIELD_0
};
/* A field's code: FIELD_0 and these. */
enum { FIELD_BYTES = 7, FIELD_SIGNED = 8, FIELD_LITTLE = 16 };

/* Beyond these a number has no whole bits. */
#define WHOLE 9007199254740992.0

struct parser {
	struct formula_pool *pool;
	const struct formula_scope *scope;
	const char *at;
	unsigned depth, nested; /* numbers on the stack; parentheses that are open */
	char *why;
	size_t why_size;
};

static int parse_sum(struct parser *p);

static int formula_fail(struct parser *p, const char *what)
{
	snprintf(p->why, p->why_size, "%s at \"%.24s\"", what, p->at);
	return -EINVAL;
}

static void skip_blanks(struct parser *p)
{
	while (*p->at == ' ' || *p->at == '\t')
		p->at++;
}

static bool formula_take(struct parser *p, char c)
{
	skip_blanks(p);
	if (*p->at != c)
		return false;
	p->at++;
	return true;
}

static int formula_add(struct parser *p, uint8_t code, double number, int change)
{
	struct formula_pool *pool = p->pool;

	if (pool->count == pool->room) {
		unsigned room = pool->room ? 2 * pool->room : 64;
		struct formula_op *ops = realloc(pool->ops, room * sizeof(*ops));

		if (!ops)
			return -ENOMEM;
		pool->ops = ops;
		pool->room = room;
	}
	pool->ops[pool->count++] = (struct formula_op){.code = code, .number = number};
	p->depth = (unsigned)((int)p->depth + change);
	return p->depth > FORMULA_DEPTH ? formula_fail(p, "a formula that is too deep") : 0;
}

/* Letters, digits and _ from p->at on; their length. */
static size_t word_length(const struct parser *p)
{
	size_t n = strspn(p->at, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789");

	return n < FORMULA_NAME ? n : 0;
}

static bool formula_is(const char *word, size_t n, const char *text)
{
	return strlen(text) == n && memcmp(word, text, n) == 0;
}

/* u8, s24le: its code, or 0. */
static uint8_t field_code(const char *name, size_t n)
{
	static const char *const sizes[] = {"8", "16", "24", "32"};
	bool little = n > 3 && memcmp(name + n - 2, "le", 2) == 0;

	if (name[0] != 'u' && name[0] != 's')
		return 0;
	for (unsigned i = 0; i < 4; i++)
		if (formula_is(name + 1, n - 1 - (little ? 2 : 0), sizes[i]))
			return (uint8_t)(FIELD_0 + i + 1 + (name[0] == 's' ? FIELD_SIGNED : 0) +
			                 (little ? FIELD_LITTLE : 0));
	return 0;
}

static int field(struct parser *p, uint8_t code)
{
	unsigned bytes = (unsigned)(code - FIELD_0) & FIELD_BYTES;
	char *end;
	unsigned long at;

	if (!formula_take(p, '('))
		return formula_fail(p, "expected (");
	skip_blanks(p);
	at = strtoul(p->at, &end, 0);
	if (end == p->at || *p->at == '-')
		return formula_fail(p, "expected the number of a byte");
	p->at = end;
	if (at > p->scope->bytes || bytes > p->scope->bytes - at)
		return formula_fail(p, "bytes that are not read before");
	return formula_take(p, ')') ? formula_add(p, code, (double)at, 1)
	                            : formula_fail(p, "expected )");
}

/* A function of n formulas. */
static int call(struct parser *p, enum code code, unsigned n)
{
	int err = formula_take(p, '(') ? 0 : formula_fail(p, "expected (");

	for (unsigned i = 0; !err && i < n; i++) {
		err = i && !formula_take(p, ',') ? formula_fail(p, "expected ,") : 0;
		err = err ? err : parse_sum(p);
	}
	if (!err && !formula_take(p, ')'))
		err = formula_fail(p, "expected )");
	return err ? err : formula_add(p, (uint8_t)code, 0, 1 - (int)n);
}

static int named(struct parser *p)
{
	static const struct {
		const char *name;
		uint8_t code, n;
	} functions[] = {{"bits", BITS, 3},
	                 {"min", LEAST, 2},
	                 {"max", MOST, 2},
	                 {"floor", FLOOR, 1},
	                 {"pow", POWER, 2}};
	const char *name = p->at;
	size_t n = word_length(p);
	uint8_t code;

	for (unsigned i = 0; n && i < p->scope->name_count; i++) {
		if (formula_is(name, n, p->scope->names[i])) {
			p->at += n;
			return formula_add(p, NAME, i, 1);
		}
	}
	if (!n)
		return formula_fail(p, "expected a number, a field or a name");
	code = field_code(name, n);
	if (code) {
		p->at += n;
		return field(p, code);
	}
	for (unsigned i = 0; i < sizeof(functions) / sizeof(functions[0]); i++) {
		if (formula_is(name, n, functions[i].name)) {
			p->at += n;
			return call(p, functions[i].code, functions[i].n);
		}
	}
	return formula_fail(p, "no such name");
}

static int primary(struct parser *p)
{
	char *end;
	int err;

	skip_blanks(p);
	if ((*p->at >= '0' && *p->at <= '9') || *p->at == '.') {
		double number = strtod(p->at, &end);

		if (end == p->at || !isfinite(number))
			return formula_fail(p, "expected a number");
		p->at = end;
		return formula_add(p, NUMBER, number, 1);
	}
	if (*p->at == '$') {
		if (!p->scope->set)
			return formula_fail(p, "$ stands for what is written, only in set");
		p->at++;
		return formula_add(p, SET, 0, 1);
	}
	if (!formula_take(p, '('))
		return named(p);
	if (p->nested == FORMULA_DEPTH)
		return formula_fail(p, "too many parentheses");
	p->nested++;
	err = parse_sum(p);
	p->nested--;
	return err ? err : formula_take(p, ')') ? 0 : formula_fail(p, "expected )");
}

static int unary(struct parser *p)
{
	bool negative = false;
	int err;

	while (formula_take(p, '-'))
		negative = !negative;
	err = primary(p);
	return err || !negative ? err : formula_add(p, NEGATE, 0, 0);
}

/* It says the same whatever is read or written. */
static bool is_constant(const struct formula_pool *pool, struct formula formula)
{
	for (unsigned i = 0; i < formula.count; i++) {
		uint8_t code = pool->ops[formula.first + i].code;

		if (code == SET || code == NAME || code >= FIELD_0)
			return false;
	}
	return true;
}

static int parse_product(struct parser *p)
{
	int err = unary(p);

	while (!err) {
		enum code code = formula_take(p, '*')   ? MULTIPLY
		                 : formula_take(p, '/') ? DIVIDE
		                                        : NUMBER;

		if (code == NUMBER)
			break;
		struct formula divisor = {.first = p->pool->count};
		err = unary(p);
		divisor.count = p->pool->count - divisor.first;
		if (!err && code == DIVIDE && is_constant(p->pool, divisor) &&
		    formula_value(p->pool, divisor, &(struct formula_input){0}) == 0)
			err = formula_fail(p, "a division by 0");
		err = err ? err : formula_add(p, (uint8_t)code, 0, -1);
	}
	return err;
}

static int parse_sum(struct parser *p)
{
	int err = parse_product(p);

	while (!err) {
		enum code code = formula_take(p, '+')   ? ADD
		                 : formula_take(p, '-') ? SUBTRACT
		                                        : NUMBER;

		if (code == NUMBER)
			break;
		err = parse_product(p);
		err = err ? err : formula_add(p, (uint8_t)code, 0, -1);
	}
	return err;
}

int formula_parse(struct formula_pool *pool, const struct formula_scope *scope, const char **text,
                  struct formula *formula, char *why, size_t why_size)
{
	struct parser p = {
		.pool = pool, .scope = scope, .at = *text, .why = why, .why_size = why_size};
	int err;

	formula->first = pool->count;
	err = parse_sum(&p);
	formula->count = pool->count - formula->first;
	skip_blanks(&p);
	if (!err && is_constant(pool, *formula) &&
	    !isfinite(formula_value(pool, *formula, &(struct formula_input){0})))
		err = formula_fail(&p, "a formula that is never a number, before");
	*text = p.at;
	return err;
}

/* --- Evaluation ------------------------------------------------------------------------------ */

static double field_value(uint8_t code, const uint8_t *at)
{
	unsigned n = code & FIELD_BYTES;
	uint32_t raw = 0;

	if (!n || !at)
		return NAN;
	for (unsigned i = 0; i < n; i++)
		raw = raw << 8 | at[code & FIELD_LITTLE ? n - 1 - i : i];
	if (code & FIELD_SIGNED && raw >> (8 * n - 1))
		return (double)raw - (n == 4 ? 4294967296.0 : (double)(UINT32_C(1) << 8 * n));
	return raw;
}

/* Of a whole number from bit `from` on n bits. */
static double bits_of(double value, double from, double n)
{
	if (!(value >= 0 && value < WHOLE && from >= 0 && from < 53 && n >= 1 && n <= 32))
		return NAN;
	return (double)((uint64_t)value >> (unsigned)from & ((UINT64_C(1) << (unsigned)n) - 1));
}

static double combine(enum code code, double a, double b)
{
	if (isnan(a) || isnan(b))
		return NAN;
	switch (code) {
	case ADD:
		return a + b;
	case SUBTRACT:
		return a - b;
	case MULTIPLY:
		return a * b;
	case DIVIDE:
		return a / b;
	case LEAST:
		return a < b ? a : b;
	case MOST:
		return a > b ? a : b;
	default:
		return pow(a, b);
	}
}

double formula_value(const struct formula_pool *pool, struct formula formula,
                     const struct formula_input *input)
{
	double stack[FORMULA_DEPTH + 1] = {0};
	unsigned top = 0;

	for (unsigned i = 0; i < formula.count; i++) {
		const struct formula_op *op = &pool->ops[formula.first + i];

		if (op->code >= FIELD_0)
			stack[top++] = field_value((uint8_t)(op->code - FIELD_0),
			                           input->bytes + (unsigned)op->number);
		else if (op->code == NUMBER)
			stack[top++] = op->number;
		else if (op->code == SET)
			stack[top++] = input->set;
		else if (op->code == NAME)
			stack[top++] = input->names[(unsigned)op->number];
		else if (op->code == NEGATE)
			stack[top - 1] = -stack[top - 1];
		else if (op->code == FLOOR)
			stack[top - 1] = floor(stack[top - 1]);
		else if (op->code == BITS) {
			top -= 2;
			stack[top - 1] = bits_of(stack[top - 1], stack[top], stack[top + 1]);
		} else {
			top--;
			stack[top - 1] = combine(op->code, stack[top - 1], stack[top]);
		}
	}
	return stack[0];
}

bool formula_is_byte(const struct formula_pool *pool, struct formula formula)
{
	if (!is_constant(pool, formula))
		return true;
	double value = formula_value(pool, formula, &(struct formula_input){0});
	return value >= 0 && value <= 255 && value == floor(value);
}
