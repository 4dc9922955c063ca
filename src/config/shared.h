/* SPDX-License-Identifier: MIT */
/* Items that write the same register of a device. */
#pragma once

struct config;
struct config_report;

/*
 * Warn of two items, outputs or inputs with Writable, that set the same bits while one is written
 * again by Restore: that undoes the command of the other.
 * name: only pairs with that item; NULL: all.
 */
void shared_check(const struct config *config, const char *name, struct config_report *report);
