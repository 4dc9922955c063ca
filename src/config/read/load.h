/* SPDX-License-Identifier: MIT */
/* The configuration made from a .rio document: its driver block, its items, its targets. */
#pragma once

#include <stddef.h>

struct config;
struct config_report;

/* Where a program has its configuration NAME.rio if its command line names none. */
#define CONFIG_DIR "/etc/owsd"

/*
 * Read and check a file. Returns 0, -EINVAL when report->errors > 0 (*config is NULL then, or, if
 * the report keeps what is wrong, there to be checked and freed), or a negative errno of reading
 * the file (also reported). Blocking (file).
 */
int config_load(const char *file, struct config_report *report, struct config **config);
/* The same from memory; file is for messages. */
int config_parse(const char *file, const char *text, size_t len, struct config_report *report,
                 struct config **config);
/* Replace the targets (owsd -t); each text may itself hold commas and bars. 0 or -EINVAL. */
int config_set_targets(struct config *config, const char *const *texts, unsigned count,
                       struct config_report *report);
/* Replace where the owserver protocol is served (owsd -l). 0 or -EINVAL. */
int config_set_listens(struct config *config, const char *const *texts, unsigned count,
                       struct config_report *report);
void config_free(struct config *config);
