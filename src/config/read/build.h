/* SPDX-License-Identifier: MIT */
/* Between the files that make a struct config out of a document. */
#pragma once

#include "src/config/read/arena.h"
#include "src/config/read/config.h"

#define CONFIG_ITEMS_MAX 65535

/* What config_free() gets back from the struct config that is its member. */
struct config_box {
	struct arena arena;
	struct config config;
};

struct option_value;

struct build {
	struct config_box *box;
	struct config_report *report;
	bool no_memory;
	unsigned item_errors; /* errors of the report before this Item */
};

/*
 * Nothing of this Item was refused so far. Else what its other keys do is not known, and a warning
 * that one does nothing may only follow from the error.
 */
static inline bool build_sound(const struct build *build)
{
	return build->report->errors == build->item_errors;
}

/* A copy of the text in the arena; "" and no_memory set when there is no memory. */
const char *build_keep(struct build *build, const char *text, size_t len);

/* Zeroed room for one element more than count; without memory returns NULL and sets no_memory. */
void *build_take(struct build *build, size_t count, size_t size);

/*
 * The next part of a list, without the blanks around it; false: there is none. *text goes behind
 * the separator, and is NULL after the last part.
 */
bool build_part(const char **text, const char *separators, const char **part, size_t *len);

/* What follows from several keys of a block, when each key by itself has been taken. */
typedef void block_derive(struct build *build, const struct option_value *values);
