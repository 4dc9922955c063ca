/* SPDX-License-Identifier: MIT */
/* Keys whose value is a text: checked, reported and kept. */
#ifndef CONFIG_TEXT_KEY_H
#define CONFIG_TEXT_KEY_H

#include "src/config/build.h"

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

#endif
