/* SPDX-License-Identifier: MIT */
/* Between the files that make a struct config out of a document. */
#pragma once

#include "src/config/read/options.h"

#define CONFIG_ITEMS_MAX 65535

/* What config_free() gets back from the struct config that is its member. */
struct config_box {
	struct arena arena;
	struct config config;
};

struct build {
	struct config_box *box;
	struct config_report *report;
	bool no_memory;
};

/* A copy of the text in the arena; "" and no_memory set when there is no memory. */
const char *build_keep(struct build *build, const char *text, size_t len);

/* Zeroed room for one element more than count; without memory returns NULL and sets no_memory. */
void *build_take(struct build *build, size_t count, size_t size);

/*
 * The next part of a list, without the blanks around it; false: there is none. *text goes behind
 * the separator, and is NULL after the last part.
 */
bool build_part(const char **text, const char *separators, const char **part, size_t *len);

/* Keys whose value is a text: checked, reported and kept. */
#define TEXT_KEY_LETTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-"
#define TEXT_KEY_MAX 255 /* bytes of a path or another long text */
#define TEXT_KEY_NAME 63

/* Why the text cannot be one; NULL: it can. */
typedef const char *text_check(const char *text);
text_check text_is_short, text_is_path, text_is_name;
/* A path, or the name of a credential. */
text_check text_is_file;

/*
 * The text of an option, kept; its preset or NULL if it is not given, or empty. check: an error is
 * reported, without the text where that may hold a password; NULL: it may be any.
 */
const char *text_key(struct build *build, const struct option_value *values, enum option option,
                     text_check *check);
