/* SPDX-License-Identifier: MIT */
/* Inside src/ground/board: files below a root directory. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#define BOARD_PATH 512
#define BOARD_ROOT 256 /* the root has at most so many bytes */

/* The path below the root. */
void board_path(char *path, const char *root, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
/* A text of the device tree, without the NUL at its end; "" where there is none. */
void board_text(const char *root, const char *file, char *text, size_t size);
/* A number of the device tree, or 0. */
unsigned board_cell(const char *root, const char *file);
bool board_there(const char *root, const char *file);
/* The last component of a link's target; "" without such a link. */
void board_link(const char *root, const char *file, char *name, size_t size);
/* The name of the firmware's config.txt on this system. */
const char *board_config(const char *root);
/*
 * Does config.txt have this line for every board, as "dtparam=i2c_arm=on"? A line may hold several
 * parameters.
 */
bool board_configured(const char *root, const char *line);
