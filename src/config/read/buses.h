/* SPDX-License-Identifier: MIT */
/* The Bus blocks. What an option means is the backend's: here is only what its value looks like. */
#pragma once

struct build;
struct config;
struct config_bus;
struct config_report;
struct rio_node;

/* All Bus blocks of the driver's block. */
void buses_build(struct build *build, const struct rio_node *driver);

/* The Bus block of a target, however it is spelt; NULL: it has none. */
const struct config_bus *config_bus(const struct config *config, const char *target);
/*
 * Read the files that options name, so that a reload takes a file with other contents for another
 * option. A file that cannot be read, or is too long, is the backend's to report.
 */
void config_hash_files(struct config *config);
/* Warn of Bus blocks whose target is not among the configured targets. */
void config_check_buses(const struct config *config, struct config_report *report);
