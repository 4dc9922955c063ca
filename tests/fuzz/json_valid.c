/* SPDX-License-Identifier: MIT */
/* A small, strict parser of JSON, which judges the output of owsctl. */
#include <string.h>

#include "tests/fuzz/json_valid.h"

#define DEEP 64

struct text {
	const unsigned char *at, *end;
};

static bool take(struct text *t, char c)
{
	if (t->at == t->end || *t->at != (unsigned char)c)
		return false;
	t->at++;
	return true;
}

static bool word(struct text *t, const char *what)
{
	while (*what)
		if (!take(t, *what++))
			return false;
	return true;
}

static bool digits(struct text *t)
{
	const unsigned char *begin = t->at;

	while (t->at < t->end && *t->at >= '0' && *t->at <= '9')
		t->at++;
	return t->at > begin;
}

static bool number(struct text *t)
{
	take(t, '-');
	if (!take(t, '0') && !digits(t))
		return false;
	if (take(t, '.') && !digits(t))
		return false;
	if (take(t, 'e') || take(t, 'E')) {
		if (!take(t, '+'))
			take(t, '-');
		return digits(t);
	}
	return true;
}

static bool escape(struct text *t)
{
	if (t->at == t->end)
		return false;
	if (*t->at != 'u')
		return strchr("\"\\/bfnrt", *t->at++) != NULL;
	t->at++;
	for (int i = 0; i < 4; i++)
		if (t->at == t->end || !strchr("0123456789abcdefABCDEF", *t->at++))
			return false;
	return true;
}

/* One character of several bytes; not one longer than need be, no surrogate. */
static bool utf8(struct text *t)
{
	unsigned c = *t->at++, more = c >= 0xf0 ? 3 : c >= 0xe0 ? 2 : 1;
	unsigned least = more == 3 ? 0x10000 : more == 2 ? 0x800 : 0x80;

	if (c < 0xc2 || c > 0xf4)
		return false;
	c &= 0x3fu >> more;
	for (; more; more--) {
		if (t->at == t->end || (*t->at & 0xc0) != 0x80)
			return false;
		c = c << 6 | (*t->at++ & 0x3f);
	}
	return c >= least && c <= 0x10ffff && (c < 0xd800 || c > 0xdfff);
}

static bool string(struct text *t)
{
	if (!take(t, '"'))
		return false;
	while (t->at < t->end && *t->at != '"') {
		if (*t->at < ' ')
			return false;
		if (*t->at >= 0x80) {
			if (!utf8(t))
				return false;
		} else if (*t->at++ == '\\' && !escape(t)) {
			return false;
		}
	}
	return take(t, '"');
}

static bool value(struct text *t, int depth)
{
	bool object;

	if (t->at == t->end || depth == DEEP)
		return false;
	object = *t->at == '{';
	if (*t->at == '"')
		return string(t);
	if (*t->at == 't')
		return word(t, "true");
	if (*t->at == 'f')
		return word(t, "false");
	if (*t->at == 'n')
		return word(t, "null");
	if (!object && *t->at != '[')
		return number(t);
	t->at++;
	if (take(t, object ? '}' : ']'))
		return true;
	do
		if ((object && (!string(t) || !take(t, ':'))) || !value(t, depth + 1))
			return false;
	while (take(t, ','));
	return take(t, object ? '}' : ']');
}

bool json_valid(const char *text, size_t n)
{
	struct text t = {(const unsigned char *)text, (const unsigned char *)text + n};

	return value(&t, 0) && t.at == t.end;
}
