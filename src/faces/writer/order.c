/* SPDX-License-Identifier: MIT */
/*
 * Reads the head of a request: a first line with the version, then lines "key: value". The peer may
 * be hostile: each length is checked before bytes are used, and no key may stand twice.
 */
#include <errno.h>
#include <stdbool.h>
#include <string.h>

#include "src/config/read/rio.h"
#include "src/faces/writer/order.h"
#include "src/ground/text/printable.h"

#define FIRST "owsd-writer 1\n"

enum key {
	KEY_DO,
	KEY_BASE,
	KEY_FOR,
	KEY_LENGTH,
	KEYS,
};

struct word {
	const char *at;
	size_t len;
};

static bool is_word(struct word word, const char *text)
{
	return word.len == strlen(text) && memcmp(word.at, text, word.len) == 0;
}

static const char *parse_kind(struct word value, struct order *order)
{
	if (is_word(value, "replace"))
		order->kind = ORDER_REPLACE;
	else if (is_word(value, "restore"))
		order->kind = ORDER_RESTORE;
	else if (is_word(value, "rename"))
		order->kind = ORDER_RENAME;
	else
		return "do: expected replace, restore or rename";
	return NULL;
}

static const char *parse_base(struct word value, struct order *order)
{
	if (value.len != 0 && value.len != TAG_TEXT - 1)
		return "base: expected a tag of 16 digits, or nothing where there is no file";
	memcpy(order->base, value.at, value.len);
	order->base[value.len] = '\0';
	if (strspn(order->base, "0123456789abcdef") != value.len)
		return "base: expected hexadecimal digits in small letters";
	return NULL;
}

static const char *parse_person(struct word value, struct order *order)
{
	if (value.len >= sizeof(order->person))
		return "for: longer than 63 bytes";
	memcpy(order->person, value.at, value.len);
	order->person[printable(order->person, value.len)] = '\0';
	/* the log has it in quotes */
	printable_quoted(order->person);
	return NULL;
}

static const char *parse_length(struct word value, struct order *order)
{
	size_t length = 0;

	if (!value.len)
		return "length: expected a number of bytes";
	for (size_t i = 0; i < value.len; i++) {
		if (value.at[i] < '0' || value.at[i] > '9')
			return "length: expected a number of bytes";
		length = length * 10 + (size_t)(value.at[i] - '0');
		if (length > RIO_FILE_MAX)
			return "length: longer than a configuration may be";
	}
	order->length = length;
	return NULL;
}

static const struct {
	const char *name;
	const char *(*take)(struct word value, struct order *order);
} keys[KEYS] = {
	[KEY_DO] = {"do", parse_kind},
	[KEY_BASE] = {"base", parse_base},
	[KEY_FOR] = {"for", parse_person},
	[KEY_LENGTH] = {"length", parse_length},
};

/* had: a bit for each key that came before. Returns what is wrong, or NULL. */
static const char *parse_head_line(struct word line, unsigned *had, struct order *order)
{
	const char *colon = memchr(line.at, ':', line.len);
	struct word name = {line.at, colon ? (size_t)(colon - line.at) : 0}, value;

	if (!colon)
		return "expected lines of the form key: value";
	value = (struct word){colon + 1, line.len - name.len - 1};
	if (value.len && *value.at == ' ')
		value = (struct word){value.at + 1, value.len - 1};
	for (size_t i = 0; i < line.len; i++)
		if ((unsigned char)line.at[i] < ' ' || line.at[i] == 0x7f)
			return "a control character stands in the head";
	for (unsigned i = 0; i < KEYS; i++) {
		if (!is_word(name, keys[i].name))
			continue;
		if (*had & 1u << i)
			return "a key stands there twice";
		*had |= 1u << i;
		return keys[i].take(value, order);
	}
	return "there is no such key: do, base, for and length are known";
}

static const char *check_keys(unsigned had, const struct order *order)
{
	if (!(had & 1u << KEY_DO))
		return "do: is missing";
	/* who renames names what is there now, whatever the file was */
	if (order->kind == ORDER_RENAME && (had & 1u << KEY_BASE))
		return "base: a rename has none";
	if (order->kind != ORDER_RENAME && !(had & 1u << KEY_BASE))
		return "base: is missing";
	if (order->kind != ORDER_RESTORE && !(had & 1u << KEY_LENGTH))
		return "length: is missing";
	if (order->kind == ORDER_RESTORE && (had & 1u << KEY_LENGTH))
		return "length: a restore has no bytes";
	return NULL;
}

int order_parse(const char *text, size_t len, struct order *order, const char **why)
{
	size_t first = strlen(FIRST), room = len < ORDER_HEAD_MAX ? len : ORDER_HEAD_MAX;
	const char *end, *line;
	unsigned had = 0;

	*why = NULL;
	*order = (struct order){0};
	if (memcmp(text, FIRST, len < first ? len : first) != 0) {
		*why = "expected \"owsd-writer 1\" and a line end";
		return -EINVAL;
	}
	end = memmem(text, room, "\n\n", 2);
	if (!end && len < ORDER_HEAD_MAX)
		return 0;
	if (!end) {
		*why = "the head is longer than 1024 bytes";
		return -EINVAL;
	}
	for (line = text + first; line <= end && !*why;) {
		const char *next = memchr(line, '\n', (size_t)(end + 1 - line));

		*why = parse_head_line((struct word){line, (size_t)(next - line)}, &had, order);
		line = next + 1;
	}
	if (!*why)
		*why = check_keys(had, order);
	return *why ? -EINVAL : (int)(end + 2 - text);
}
