/* SPDX-License-Identifier: MIT */
/*
 * The configuration: what stands before a NUL is a .rio file, which is read, checked, printed and
 * edited; behind it come edits, a line each, with blanks between the words:
 *
 *     a NAME PATH KEY=VALUE...     s NAME KEY=VALUE...     u NAME KEY...     r NAME
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/check/check.h"
#include "src/config/edit/edit.h"
#include "src/config/edit/print.h"
#include "src/config/edit/rio_write.h"
#include "src/config/read/load.h"
#include "src/config/read/options.h"
#include "tests/fuzz/fuzz.h"

#define WORDS 8
#define EDITS 16

size_t fuzz_memory(size_t n)
{
	/* the tree, the checked configuration, two texts of it; edits make documents anew */
	return 1000000 + 400 * n;
}

static void said(void *ctx, bool is_error, const char *message)
{
	(void)ctx;
	(void)is_error;
	TEST_ASSERT_TRUE(strlen(message) > 0);
	for (; *message; message++)
		TEST_ASSERT_TRUE_MESSAGE((unsigned char)*message >= ' ' && *message != 0x7f,
		                         "a message has control characters");
}

static char *print(const struct config *config)
{
	char *text = NULL;
	size_t size;
	FILE *out = open_memstream(&text, &size);

	TEST_ASSERT_NOT_NULL(out);
	config_print(config, out);
	fclose(out);
	TEST_ASSERT_EQUAL_size_t_MESSAGE(strlen(text), size, "a NUL was printed");
	return text;
}

static struct config *parse(const char *text, size_t n, struct config_report *report)
{
	struct config *config;
	int err;

	*report = (struct config_report){.line = said, .keeps_wrong = true};
	err = config_parse("f", text, n, report, &config);
	TEST_ASSERT_TRUE(err == 0 || err == -EINVAL);
	TEST_ASSERT_EQUAL_MESSAGE(err == 0, report->errors == 0, "errors do not fit the status");
	TEST_ASSERT_TRUE_MESSAGE(err || config, "status does not fit the result");
	if (config)
		config_check_items(config, NULL, report);
	if (!err)
		return config;
	config_free(config);
	return NULL;
}

/* What was understood, printed, is understood as the same. */
static void check_print(const char *text, size_t n)
{
	struct config_report report;
	struct config *first = parse(text, n, &report), *second;
	char *once, *twice;

	if (!first)
		return;
	once = print(first);
	second = parse(once, strlen(once), &report);
	TEST_ASSERT_NOT_NULL_MESSAGE(second, "what --check prints is refused");
	twice = print(second);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(once, twice, "printed again it is another");
	free(once);
	free(twice);
	config_free(first);
	config_free(second);
}

static void check_node(const struct rio *rio, const struct rio_node *node)
{
	size_t at = node->value_begin;

	TEST_ASSERT_TRUE(node->begin <= node->value_begin && node->value_begin <= node->value_end);
	TEST_ASSERT_TRUE(node->value_end <= node->end && node->end <= rio->len);
	TEST_ASSERT_TRUE(strlen(node->key) <= RIO_KEY_MAX);
	for (const struct rio_node *child = node->first; child; child = child->next) {
		TEST_ASSERT_TRUE_MESSAGE(child->begin >= at, "nodes overlap");
		TEST_ASSERT_TRUE(child->parent == node);
		check_node(rio, child);
		at = child->end;
	}
	TEST_ASSERT_TRUE(at <= node->end);
}

static unsigned errors_of(const char *text, size_t n)
{
	struct config_report report = {.line = said};
	struct rio *rio;

	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", text, n, &report, &rio));
	check_node(rio, &rio->root);
	rio_free(rio);
	return report.errors;
}

static const struct rio_node *item_of(const struct rio *rio, const char *name)
{
	const struct rio_node *driver = rio_child(&rio->root, "OwsDrv");
	const struct rio_node *item = driver ? rio_child(driver, "Item") : NULL;

	for (; item; item = rio_next(item)) {
		const struct rio_node *found = rio_child(item, "Name");

		if (item->kind == RIO_BLOCK && found && !strcmp(found->value, name))
			return item;
	}
	return NULL;
}

static unsigned items_of(const struct rio *rio)
{
	const struct rio_node *driver = rio_child(&rio->root, "OwsDrv");
	unsigned items = 0;

	for (const struct rio_node *node = driver ? driver->first : NULL; node; node = node->next)
		items += node->kind == RIO_BLOCK && !strcmp(node->key, "Item");
	return items;
}

/* A key that was set is there, unless it went into the bits of IOType. */
static void check_set(const struct rio *rio, const char *name, const char *setting)
{
	const char *value = strchr(setting, '=') + 1;
	char key[RIO_KEY_MAX + 1];
	const struct rio_node *item = item_of(rio, name), *node;

	snprintf(key, sizeof(key), "%.*s", (int)(value - setting - 1), setting);
	if (!item)
		return;
	node = rio_child(item, key);
	if (!node) {
		TEST_ASSERT_NOT_NULL_MESSAGE(rio_child(item, "IOType"), setting);
		return;
	}
	TEST_ASSERT_EQUAL_STRING_MESSAGE(value, node->value, "a value was set and is another");
}

static unsigned split(char *line, const char **words)
{
	unsigned n = 0;
	char *rest;

	for (char *word = strtok_r(line, " ", &rest); word && n < WORDS;
	     word = strtok_r(NULL, " ", &rest))
		words[n++] = word;
	return n;
}

static int apply(struct rio **rio, const char **words, unsigned n, unsigned items,
                 struct config_report *report)
{
	int err = -EINVAL;

	switch (*words[0]) {
	case 'a':
		err = edit_add(rio, words[1], words[2], words + 3, n - 3, report);
		if (!err)
			TEST_ASSERT_EQUAL_UINT(items + 1, items_of(*rio));
		return err;
	case 's':
		err = edit_set(rio, words[1], words + 2, n - 2, report);
		/* after a setting of Name it is another's */
		if (!err && n == 3)
			check_set(*rio, words[1], words[2]);
		break;
	case 'u':
		err = edit_unset(rio, words[1], words + 2, n - 2, report);
		break;
	case 'r':
		err = edit_remove(rio, words[1], report);
		if (!err)
			TEST_ASSERT_EQUAL_UINT(items - 1, items_of(*rio));
		return err;
	}
	if (!err)
		TEST_ASSERT_EQUAL_UINT_MESSAGE(items, items_of(*rio), "an item came or went");
	return err;
}

/* Returns whether it was done. */
static bool edit(struct rio **rio, char *line)
{
	struct config_report report = {.line = said};
	const char *words[WORDS];
	unsigned n = split(line, words);
	int err;

	if (n < 2 || !strchr("asur", *words[0]) || (*words[0] == 'a' && n < 3))
		return false;
	err = apply(rio, words, n, items_of(*rio), &report);
	TEST_ASSERT_TRUE(err == 0 || err == -EINVAL);
	TEST_ASSERT_EQUAL_MESSAGE(err != 0, report.errors != 0, "a reason is missing");
	return err == 0;
}

static void check_edits(const char *text, size_t n, struct fuzz *fuzz)
{
	struct config_report report = {.line = said};
	struct rio *rio;
	char line[300];

	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", text, n, &report, &rio));
	check_node(rio, &rio->root);
	/* as owsctl does: what has errors is not edited */
	for (int i = 0; i < EDITS && fuzz_left(fuzz) && !report.errors; i++) {
		fuzz_line(fuzz, line, sizeof(line));
		if (!edit(&rio, line))
			break;
		TEST_ASSERT_EQUAL_UINT_MESSAGE(0, errors_of(rio->text, rio->len),
		                               "an edit has broken the file");
	}
	rio_free(rio);
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	const uint8_t *behind = n ? memchr(bytes, 0, n) : NULL;
	size_t len = behind ? (size_t)(behind - bytes) : n;
	struct fuzz fuzz = {.at = bytes + len + (behind != NULL), .end = bytes + n};
	char *text = malloc(len + 1);

	TEST_ASSERT_NOT_NULL(text);
	if (len)
		memcpy(text, bytes, len);
	text = realloc(text, len ? len : 1);
	check_print(text, len);
	/* a NUL in the file itself is refused like any control character */
	errors_of((const char *)bytes, n);
	check_edits(text, len, &fuzz);
	free(text);
}
