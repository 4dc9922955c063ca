/* SPDX-License-Identifier: MIT */
/* Between the files that make a struct config out of a document. */
#ifndef CONFIG_BUILD_H
#define CONFIG_BUILD_H

#include "src/config/options.h"

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

#endif
