/* SPDX-License-Identifier: MIT */
/* The Bus blocks. What an option means is the backend's: here is only what its value looks like. */
#ifndef CONFIG_BUSES_H
#define CONFIG_BUSES_H

struct build;
struct config;
struct config_bus;
struct config_report;
struct rio_node;

/* All Bus blocks of the driver's block. */
void buses_build(struct build *build, const struct rio_node *driver);

/* The Bus block of a target, however it is spelt; NULL: it has none. */
const struct config_bus *config_bus(const struct config *config, const char *target);
/* Warn of Bus blocks whose target is not among the configured targets. */
void config_check_buses(const struct config *config, struct config_report *report);

#endif
