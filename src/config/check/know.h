/* SPDX-License-Identifier: MIT */
/* What the families' tables decide of an item. */
#pragma once

struct config;
struct config_item;
struct config_report;

/*
 * Fill in what a family decides of the items of a configuration that was parsed (config.h names
 * it). Whoever runs or prints one calls this, or config_check_items(), which warns too; who only
 * reads it needs no table of a family.
 */
void config_know(struct config *config);
/* The same of one item, and warn of keys that do nothing for such a property. */
void know_item(struct config_item *item, const char *file, struct config_report *report);
