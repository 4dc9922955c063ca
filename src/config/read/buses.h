/* SPDX-License-Identifier: MIT */
/* The Bus blocks. What an option means is the backend's: here is only what its value looks like. */
#pragma once

struct build;
struct config;
struct rio_node;

/* All Bus blocks of the driver's block. */
void buses_build(struct build *build, const struct rio_node *driver);

/*
 * Read the files that options name, so that a reload takes a file with other contents for another
 * option. A file that cannot be read, or is too long, is the backend's to report.
 */
void config_hash_files(struct config *config);
