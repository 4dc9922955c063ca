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

/* A copy in the arena; "" and no_memory if there is no room. */
const char *build_keep(struct build *build, const char *text, size_t len);

/* Zeroed room for count elements and one more; NULL and no_memory if there is none. */
void *build_take(struct build *build, size_t count, size_t size);

/*
 * The one spelling by which targets of an owserver are compared: "owserver:host:port"; others as
 * they are.
 */
#define TARGET_MAX 255
#define TARGET_CANONICAL (TARGET_MAX + 32)
void target_canonical(const char *text, char out[TARGET_CANONICAL]);
/* Do they mean the same target? */
bool target_same(const char *a, const char *b);

/* All Bus blocks of the driver's block. */
void buses_build(struct build *build, const struct rio_node *driver);

/* "a, b | c" behind the targets there are. Errors are said at place. */
void targets_add(struct build *build, const char *text, struct place place);

/* Where the owserver protocol is served, and to whom. */
void serve_build(struct build *build, const struct option_value *values);
/* The addresses of owsd -l in their place. 0 or -EINVAL. */
int serve_listens(struct build *build, const char *const *texts, unsigned count);

/* One Item block. */
void item_build(struct build *build, const struct rio_node *block, struct config_item *item);
/* Its limit alarms, when its type is known. */
void limits_build(struct build *build, const struct option_value *values, struct config_item *item);
/* What concerns items together: names. */
void items_check(struct build *build, const struct place *names);

#endif
