/* SPDX-License-Identifier: MIT */
/* Targets as they are written: lists with commas and bars, and auto. */
#pragma once

#include <stddef.h>

#include "src/config/read/report.h"

struct build;

/*
 * "auto" stands for its ways: an owserver here, else every DS2482, else the kernel's masters. The
 * one of the row *row or of a later one, and the row after it; NULL: no more.
 */
const char *config_auto_way(unsigned *row);

#define TARGET_MAX 255

/*
 * The target with the file of sim:FILE or replay:FILE as relative_file() has it; warns if position
 * has a line.
 */
const char *target_of_file(struct build *build, const char *text, struct rio_position position);
/* Parse "a, b | c" and append the targets. Errors are reported at position. */
void targets_add(struct build *build, const char *text, struct rio_position position);

/*
 * text, whose first `prefix` bytes precede the name of a file, with that name as it is to be
 * opened. A relative one counts from the folder of the configuration; one that is only in the
 * working directory is taken from there, with a warning at *position unless position is NULL. In
 * the arena.
 */
const char *relative_file(struct build *build, const char *text, size_t prefix,
                          const struct rio_position *position);
