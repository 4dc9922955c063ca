/* SPDX-License-Identifier: MIT */
/*
 * A plot of a signal in characters: each is two columns and four rows of dots (Unicode's braille
 * patterns). Pure: the picture goes into memory.
 */
#pragma once

#include <stdbool.h>

#include "src/public/ows_history.h"

#define PLOT_WIDTH_MAX 400 /* characters */
#define PLOT_HEIGHT_MAX 40

/*
 * Draw 2 * width points as height lines of width characters and a line below them, which shows for
 * each character what is known: "─" a good value, "×" something that is not good, " " nothing. Each
 * dot column reaches from the minimum to the maximum. *low and *high are the values at the lower
 * and the upper edge; false: no point has a good value. text has PLOT_TEXT bytes at most, each
 * line ends with a newline.
 */
#define PLOT_TEXT ((PLOT_HEIGHT_MAX + 1) * (PLOT_WIDTH_MAX * 3 + 1) + 1)
bool plot_draw(const struct ows_history_point *points, int width, int height, double *low,
               double *high, char text[PLOT_TEXT]);
