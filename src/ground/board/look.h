/* SPDX-License-Identifier: MIT */
/* Finds out which board this machine is. */
#pragma once

#include <stddef.h>

struct board_report;

/* The folder of the board data: $OWSD_BOARDS, else beside this program. */
void board_folder(char *folder, size_t size);
/*
 * Look at the files below root ("" is this machine's). id names the data of a board that cannot be
 * detected; NULL: none. Returns 0, or why and -ENOENT: there is no such board, -ENAMETOOLONG: root
 * is longer than 256 characters. Data that cannot be read is a note.
 */
int board_look(const char *root, const char *folder, const char *id, struct board_report *report,
               char *why, size_t why_size);
