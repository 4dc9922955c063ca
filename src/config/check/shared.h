/* SPDX-License-Identifier: MIT */
/* Items that write the same register of a device. */
#pragma once

struct config;
struct config_report;

/*
 * Warn of two items, outputs or inputs with Writable, that set the same bits: owsd writes the last
 * command of either, and the other then differs from what it was commanded. Restore of one undoes
 * the commands of the other.
 * name: only pairs with that item; NULL: all.
 */
void shared_check(const struct config *config, const char *name, struct config_report *report);
