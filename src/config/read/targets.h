/* SPDX-License-Identifier: MIT */
/*
 * Targets as they are written: lists with commas and bars, auto, and which spellings are the same.
 */
#pragma once

#include <stdbool.h>

#include "src/config/read/report.h"

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
/* The target with the file of sim:FILE as relative_file() has it; warns if place has a line. */
const char *target_of_file(struct build *build, const char *text, struct place place);
/* Parse "a, b | c" and append the targets. Errors are reported at place. */
void targets_add(struct build *build, const char *text, struct place place);

/*
 * text, whose first `prefix` bytes precede the name of a file, with that name as it is to be
 * opened. A relative one counts from the folder of the configuration; one that is only in the
 * working directory is taken from there, with a warning at *place unless place is NULL. In the
 * arena.
 */
const char *relative_file(struct build *build, const char *text, size_t prefix,
                          const struct place *place);
