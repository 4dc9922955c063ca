/* SPDX-License-Identifier: MIT */
/*
 * Targets as they are written: lists with commas and bars, auto, and which spellings are the same.
 */
#ifndef CONFIG_TARGETS_H
#define CONFIG_TARGETS_H

#include <stdbool.h>

#include "src/config/report.h"

struct build;

extern const char *const config_auto_ways[CONFIG_AUTO_WAYS];

/*
 * The one spelling by which targets of an owserver are compared: "owserver:host:port"; others as
 * they are.
 */
#define TARGET_MAX 255
#define TARGET_CANONICAL (TARGET_MAX + 32)
void target_canonical(const char *text, char out[TARGET_CANONICAL]);
/* Do they mean the same target? */
bool target_same(const char *a, const char *b);
/* Is it a bus of owsd's own, whose values have the age of the chip's, by its cache? */
bool target_caches(const char *text);
/* The target with the file of sim:FILE as it is opened (relative.h); warns if place has a line. */
const char *target_of_file(struct build *build, const char *text, struct place place);
/* Parse "a, b | c" and append the targets. Errors are reported at place. */
void targets_add(struct build *build, const char *text, struct place place);

#endif
