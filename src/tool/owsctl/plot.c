/* SPDX-License-Identifier: MIT */
/* A plot in braille patterns. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "src/tool/owsctl/plot.h"

/* Of a character's dots, by row and column, the bit in U+2800 */
static const uint8_t dots[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};

static bool has_value(const struct ows_history_point *point)
{
	return isfinite(point->min) && isfinite(point->max);
}

static bool find_range(const struct ows_history_point *points, int count, double *low, double *high)
{
	bool any = false;

	for (int i = 0; i < count; i++) {
		if (!has_value(&points[i]))
			continue;
		if (!any || points[i].min < *low)
			*low = points[i].min;
		if (!any || points[i].max > *high)
			*high = points[i].max;
		any = true;
	}
	return any;
}

/* The row of dots of a value, 0 at the top. A constant is in the middle. */
static int dot_row(double value, double low, double high, int rows)
{
	/* halves: the difference of two doubles may be none. Those of the least doubles are 0 */
	double range = high / 2 - low / 2;
	double part = range > 0 ? (value / 2 - low / 2) / range : 0.5;
	int row = (int)floor((1 - part) * (rows - 1) + 0.5);

	return row < 0 ? 0 : row >= rows ? rows - 1 : row;
}

static char *put_pattern(char *to, uint8_t pattern)
{
	*to++ = (char)0xe2;
	*to++ = (char)(0xa0 | pattern >> 6);
	*to++ = (char)(0x80 | (pattern & 0x3f));
	return to;
}

/* The dots of one point in one line of characters. */
static uint8_t pattern_of(const struct ows_history_point *point, int column, int line, int top,
                          int bottom)
{
	uint8_t pattern = 0;

	if (!has_value(point))
		return 0;
	for (int row = 0; row < 4; row++)
		if (4 * line + row >= top && 4 * line + row <= bottom)
			pattern |= dots[row][column];
	return pattern;
}

static const char *known_as(const struct ows_history_point *two)
{
	bool known = two[0].known_ns > 0 || two[1].known_ns > 0;
	bool good = two[0].good_ns > 0 || two[1].good_ns > 0;

	return good ? "─" : known ? "×" : " ";
}

bool plot_draw(const struct ows_history_point *points, int width, int height, double *low,
               double *high, char text[PLOT_TEXT])
{
	*low = *high = 0;
	if (width > PLOT_WIDTH_MAX)
		width = PLOT_WIDTH_MAX;
	if (height > PLOT_HEIGHT_MAX)
		height = PLOT_HEIGHT_MAX;
	if (!find_range(points, 2 * width, low, high)) {
		*text = '\0';
		return false;
	}
	for (int line = 0; line < height; line++) {
		for (int i = 0; i < width; i++) {
			uint8_t pattern = 0;

			for (int column = 0; column < 2; column++) {
				const struct ows_history_point *p = &points[2 * i + column];
				int top = has_value(p) ? dot_row(p->max, *low, *high, 4 * height)
				                       : 0;
				int bottom = has_value(p) ? dot_row(p->min, *low, *high, 4 * height)
				                          : 0;

				pattern |= pattern_of(p, column, line, top, bottom);
			}
			text = put_pattern(text, pattern);
		}
		text = stpcpy(text, "\n");
	}
	for (int i = 0; i < width; i++)
		text = stpcpy(text, known_as(&points[2 * i]));
	stpcpy(text, "\n");
	return true;
}
