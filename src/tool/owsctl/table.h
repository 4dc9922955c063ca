/* SPDX-License-Identifier: MIT */
/* Columns of text, as wide as their cells, fitted into a terminal: columns are left out and cut. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#define TABLE_COLUMNS 16

struct table_column {
	const char *title;
	bool right;      /* aligned to the right; numbers at their decimal points */
	unsigned drop;   /* left out in a narrow terminal, greatest first; 0: never */
	bool spare;      /* left out before another column is cut */
	unsigned shrink; /* cut down to so many columns before another is left out; 0: not cut */
	unsigned most;   /* cut at so many columns; 0: no limit */
};

struct table {
	const struct table_column *columns;
	unsigned count;
	unsigned least[TABLE_COLUMNS]; /* the caller's: not narrower than this, if there is room */
	bool absent[TABLE_COLUMNS];    /* the caller's: not shown, however much room there is */
	unsigned natural[TABLE_COLUMNS];  /* before fitting */
	unsigned fraction[TABLE_COLUMNS]; /* right columns: the width from the decimal point on */
	unsigned width[TABLE_COLUMNS];
	bool shown[TABLE_COLUMNS];
	char **cells; /* rows * count */
	size_t rows, room;
};

void table_init(struct table *table, const struct table_column *columns, unsigned count);
void table_free(struct table *table);
/* Remove the rows; what the caller set stays. */
void table_clear(struct table *table);
/* Add a row; cells are copied and cleaned. */
void table_add(struct table *table, const char *const *cells);
/* Choose the widths; columns 0: no limit. */
void table_fit(struct table *table, unsigned columns);
/*
 * A line, without newline and trailing blanks: row, or the titles for -1. Returns its length in
 * bytes; it is cut to size.
 */
size_t table_line(const struct table *table, int row, char *line, size_t size);
/* Print all rows on stdout, as wide as they are; titled: below the titles. */
void table_print(struct table *table, bool titled);
