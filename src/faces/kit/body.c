/* SPDX-License-Identifier: MIT */
/*
 * Reads a flat JSON object, by RFC 8259. What is read is never longer than what stands there, so it
 * is written over it.
 */
#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "src/faces/kit/body.h"
#include "src/faces/show/json.h"
#include "src/ground/signal/utf8.h"

struct text {
	char *at, *end;
};

static void skip(struct text *t)
{
	while (t->at < t->end && strchr(" \t\r\n", *t->at) && *t->at)
		t->at++;
}

static bool body_take(struct text *t, char c)
{
	skip(t);
	if (t->at == t->end || *t->at != c)
		return false;
	t->at++;
	return true;
}

/* Four hexadecimal digits; -1: they are none. */
static int32_t parse_hex(struct text *t)
{
	int32_t value = 0;

	for (int i = 0; i < 4; i++) {
		int c = t->at < t->end ? tolower((unsigned char)*t->at++) : 0;

		if (!isxdigit(c))
			return -1;
		value = value * 16 + (isdigit(c) ? c - '0' : c - 'a' + 10);
	}
	return value;
}

/* After \u: a character, of one or two units. -1: it is none, or NUL. */
static int32_t parse_unicode(struct text *t)
{
	int32_t high = parse_hex(t), low;

	if (high <= 0 || (high >= 0xdc00 && high < 0xe000))
		return -1;
	if (high < 0xd800 || high >= 0xe000)
		return high;
	if (t->end - t->at < 2 || t->at[0] != '\\' || t->at[1] != 'u')
		return -1;
	t->at += 2;
	low = parse_hex(t);
	if (low < 0xdc00 || low >= 0xe000)
		return -1;
	return 0x10000 + ((high - 0xd800) << 10) + (low - 0xdc00);
}

static size_t encode(int32_t c, char bytes[4])
{
	if (c < 0x80) {
		bytes[0] = (char)c;
		return 1;
	}
	if (c < 0x800) {
		bytes[0] = (char)(0xc0 | c >> 6);
		bytes[1] = (char)(0x80 | (c & 0x3f));
		return 2;
	}
	if (c < 0x10000) {
		bytes[0] = (char)(0xe0 | c >> 12);
		bytes[1] = (char)(0x80 | (c >> 6 & 0x3f));
		bytes[2] = (char)(0x80 | (c & 0x3f));
		return 3;
	}
	bytes[0] = (char)(0xf0 | c >> 18);
	bytes[1] = (char)(0x80 | (c >> 12 & 0x3f));
	bytes[2] = (char)(0x80 | (c >> 6 & 0x3f));
	bytes[3] = (char)(0x80 | (c & 0x3f));
	return 4;
}

/* After the backslash. */
static int parse_escape(struct text *t, char **to)
{
	static const char from[] = "\"\\/bfnrt", into[] = "\"\\/\b\f\n\r\t";
	const char *known;
	int32_t c;

	if (t->at == t->end)
		return -EINVAL;
	if (*t->at == 'u') {
		t->at++;
		c = parse_unicode(t);
		if (c < 0)
			return -EINVAL;
		*to += encode(c, *to);
		return 0;
	}
	known = *t->at ? strchr(from, *t->at) : NULL;
	if (!known)
		return -EINVAL;
	t->at++;
	*(*to)++ = into[known - from];
	return 0;
}

/* A character as it stands. */
static int parse_character(struct text *t, char **to)
{
	const char *next = t->at;
	size_t left = (size_t)(t->end - t->at), len;

	if ((unsigned char)*t->at < ' ' || utf8_next(&next, &left) < 0)
		return -EINVAL;
	len = (size_t)(next - t->at);
	memmove(*to, t->at, len);
	*to += len;
	t->at += len;
	return 0;
}

static int parse_string(struct text *t, const char **text)
{
	char *to;
	int err = 0;

	if (!body_take(t, '"'))
		return -EINVAL;
	*text = to = t->at;
	while (!err && t->at < t->end && *t->at != '"') {
		if (*t->at == '\\') {
			t->at++;
			err = parse_escape(t, &to);
		} else {
			err = parse_character(t, &to);
		}
	}
	if (err || t->at == t->end)
		return -EINVAL;
	t->at++;
	*to = '\0';
	return 0;
}

static int parse_number(struct text *t, struct body_member *member)
{
	char *first = t->at;

	while (t->at < t->end && *t->at && strchr("+-.0123456789Ee", *t->at))
		t->at++;
	if (!json_is_number(first, (size_t)(t->at - first)))
		return -EINVAL;
	member->kind = BODY_NUMBER;
	/* a colon or a blank stands before it, which nobody reads again: that gives room for NUL */
	memmove(first - 1, first, (size_t)(t->at - first));
	t->at[-1] = '\0';
	member->text = first - 1;
	return 0;
}

static int parse_value(struct text *t, struct body_member *member)
{
	static const struct {
		const char *word;
		enum body_kind kind;
	} words[] = {{"true", BODY_TRUE}, {"false", BODY_FALSE}, {"null", BODY_NULL}};

	skip(t);
	if (t->at == t->end)
		return -EINVAL;
	if (*t->at == '"') {
		member->kind = BODY_STRING;
		return parse_string(t, &member->text);
	}
	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++) {
		size_t len = strlen(words[i].word);

		if ((size_t)(t->end - t->at) < len || memcmp(t->at, words[i].word, len) != 0)
			continue;
		t->at += len;
		member->kind = words[i].kind;
		member->text = words[i].word;
		return 0;
	}
	return parse_number(t, member);
}

static int parse_member(struct text *t, struct body *body)
{
	struct body_member *member = &body->members[body->count];
	int err;

	if (body->count == BODY_MEMBERS)
		return -E2BIG;
	err = parse_string(t, &member->key);
	if (err)
		return err;
	if (body_find(body, member->key) || !body_take(t, ':'))
		return -EINVAL;
	err = parse_value(t, member);
	if (!err)
		body->count++;
	return err;
}

int body_parse(char *text, size_t len, struct body *body)
{
	struct text t = {.at = text, .end = text + len};
	int err = 0;

	body->count = 0;
	if (!len || !body_take(&t, '{'))
		return -EINVAL;
	if (!body_take(&t, '}')) {
		do
			err = parse_member(&t, body);
		while (!err && body_take(&t, ','));
		if (err || !body_take(&t, '}'))
			return err ? err : -EINVAL;
	}
	skip(&t);
	return t.at == t.end ? 0 : -EINVAL;
}

const struct body_member *body_find(const struct body *body, const char *key)
{
	for (unsigned i = 0; i < body->count; i++)
		if (strcmp(body->members[i].key, key) == 0)
			return &body->members[i];
	return NULL;
}

const char *body_string(const struct body *body, const char *key)
{
	const struct body_member *member = body_find(body, key);

	return member && member->kind == BODY_STRING ? member->text : "";
}
