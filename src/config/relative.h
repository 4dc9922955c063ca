/* SPDX-License-Identifier: MIT */
/* Files that a configuration names count from its own folder. */
#ifndef CONFIG_RELATIVE_H
#define CONFIG_RELATIVE_H

#include "src/config/report.h"

struct build;

/*
 * text, whose first `prefix` bytes precede the name of a file, with that name as it is to be
 * opened. A relative one counts from the folder of the configuration; one that is only in the
 * working directory is taken from there, with a warning at *place unless place is NULL. In the
 * arena.
 */
const char *relative_file(struct build *build, const char *text, size_t prefix,
                          const struct place *place);

#endif
