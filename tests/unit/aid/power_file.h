/* SPDX-License-Identifier: MIT */
/*
 * Files of SQLite that note each write, sync, truncation and deletion, and the files that a power
 * cut at any of these leaves: what was synced, and of all that was not, each sector of 512 bytes by
 * chance. One recording at a time, in one thread.
 */
#pragma once

#include <stddef.h>

/* From here on databases that are opened note what they do: those of one name alone. */
void power_file_begin(void);
/* No more. What was noted stays until the next begin. */
void power_file_end(void);
/* How many steps were noted. */
size_t power_file_steps(void);
/*
 * Write the database, its log and its journal as they are in the directory when the power goes in
 * that step. random(n): below n.
 */
void power_file_cut(const char *directory, const char *name, size_t step,
                    unsigned (*random)(unsigned below));
