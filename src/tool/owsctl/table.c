/* SPDX-License-Identifier: MIT */
/* A table of text cells: collected, fitted into the terminal, printed line by line. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/show/text.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/table.h"

#define CELL 512 /* bytes of a cell */
#define GAP 2
#define LEAST 4 /* a column is not cut below this width */

void table_init(struct table *table, const struct table_column *columns, unsigned count)
{
	memset(table, 0, sizeof(*table));
	table->columns = columns;
	table->count = count;
}

void table_clear(struct table *table)
{
	for (size_t i = 0; i < table->rows * table->count; i++)
		free(table->cells[i]);
	table->rows = 0;
}

void table_free(struct table *table)
{
	table_clear(table);
	free(table->cells);
	table_init(table, table->columns, table->count);
}

void table_add(struct table *table, const char *const *cells)
{
	if (table->rows == table->room) {
		size_t room = table->room ? 2 * table->room : 32;

		table->cells = ctl_need(
			realloc(table->cells, room * table->count * sizeof(*table->cells)));
		table->room = room;
	}
	for (unsigned i = 0; i < table->count; i++) {
		unsigned most = table->columns[i].most;
		char clean[CELL];

		text_clean(cells[i], strlen(cells[i]), most ? most : CELL, clean, sizeof(clean));
		table->cells[table->rows * table->count + i] = ctl_need(strdup(clean));
	}
	table->rows++;
}

static unsigned total(const struct table *table)
{
	unsigned sum = 0;

	for (unsigned i = 0; i < table->count; i++)
		if (table->shown[i])
			sum += table->width[i] + (sum ? GAP : 0);
	return sum;
}

static int to_drop(const struct table *table, bool spare_only)
{
	int found = -1;

	for (unsigned i = 0; i < table->count; i++)
		if (table->shown[i] && table->columns[i].drop > 0 &&
		    (table->columns[i].spare || !spare_only) &&
		    (found < 0 || table->columns[i].drop > table->columns[found].drop))
			found = (int)i;
	return found;
}

/* The widest column that may be cut (gently: not below its shrink), or -1. */
static int widest(const struct table *table, bool gently)
{
	int found = -1;

	for (unsigned i = 0; i < table->count; i++) {
		unsigned to = !gently ? LEAST : table->columns[i].shrink;

		if (table->shown[i] && to && table->width[i] > to &&
		    (found < 0 || table->width[i] > table->width[found]))
			found = (int)i;
	}
	return found;
}

static unsigned larger(unsigned a, unsigned b)
{
	return a > b ? a : b;
}

/* The columns of a plain number from its decimal point on; -1: the cell has no such number. */
static int fraction_of(const char *cell)
{
	size_t digits, len = strspn(cell, "-");

	digits = strspn(cell + len, "0123456789");
	len += digits;
	if (digits == 0 || strspn(cell, "-") > 1)
		return -1;
	if (!cell[len])
		return 0;
	digits = strspn(cell + len + 1, "0123456789");
	return cell[len] == '.' && digits > 0 && !cell[len + 1 + digits] ? (int)digits + 1 : -1;
}

/* Find the width of a column, and the width of its longest fraction. */
static void table_measure(struct table *table, unsigned i)
{
	unsigned whole = 0, other = text_columns(table->columns[i].title);

	table->fraction[i] = 0;
	for (size_t row = 0; row < table->rows; row++) {
		const char *cell = table->cells[row * table->count + i];
		unsigned width = text_columns(cell);
		int fraction = table->columns[i].right ? fraction_of(cell) : -1;

		if (fraction < 0) {
			other = larger(other, width);
			continue;
		}
		whole = larger(whole, width - (unsigned)fraction);
		table->fraction[i] = larger(table->fraction[i], (unsigned)fraction);
	}
	table->width[i] = larger(larger(other, whole + table->fraction[i]), table->least[i]);
	table->natural[i] = table->width[i];
}

void table_fit(struct table *table, unsigned columns)
{
	int i, k;

	for (unsigned n = 0; n < table->count; n++) {
		table->shown[n] = !table->absent[n];
		table_measure(table, n);
	}
	while (columns && total(table) > columns) {
		i = to_drop(table, true);
		while (i < 0 && total(table) > columns && (k = widest(table, true)) >= 0)
			table->width[k]--;
		if (i < 0 && total(table) > columns)
			i = to_drop(table, false);
		if (i < 0)
			break;
		table->shown[i] = false;
		/* there is room again: the others are cut no more than they have to be */
		memcpy(table->width, table->natural, sizeof(table->width));
	}
	while (columns && total(table) > columns && (k = widest(table, false)) >= 0)
		table->width[k]--;
}

/* Blanks after a cell of a right column, so that the decimal points stand below each other. */
static unsigned behind(const struct table *table, unsigned i, const char *cell, unsigned pad)
{
	int fraction = table->columns[i].right ? fraction_of(cell) : -1;

	if (fraction < 0 || table->width[i] < table->natural[i])
		return 0;
	return table->fraction[i] - (unsigned)fraction < pad
	               ? table->fraction[i] - (unsigned)fraction
	               : pad;
}

size_t table_line(const struct table *table, int row, char *line, size_t size)
{
	size_t len = 0, end = 0;

	for (unsigned i = 0; i < table->count; i++) {
		const char *cell = row < 0 ? table->columns[i].title
		                           : table->cells[(size_t)row * table->count + i];
		char cut[CELL];
		size_t pad, tail, bytes;

		if (!table->shown[i])
			continue;
		pad = table->width[i] -
		      text_clean(cell, strlen(cell), table->width[i], cut, sizeof(cut));
		tail = table->columns[i].right ? behind(table, i, cell, (unsigned)pad) : pad;
		bytes = strlen(cut);
		if (len + GAP + pad + bytes >= size)
			break;
		if (len > 0) {
			memset(line + len, ' ', GAP);
			len += GAP;
		}
		memset(line + len, ' ', pad - tail);
		len += pad - tail;
		memcpy(line + len, cut, bytes);
		len += bytes;
		if (bytes > 0)
			end = len;
		memset(line + len, ' ', tail);
		len += tail;
	}
	line[end] = '\0';
	return end;
}

void table_print(struct table *table, bool titled)
{
	char line[8192];

	table_fit(table, 0);
	for (int row = titled ? -1 : 0; row < (int)table->rows; row++) {
		table_line(table, row, line, sizeof(line));
		puts(line);
	}
}
