/* SPDX-License-Identifier: MIT */
#include "table.h"
#include "text.h"

#include <stdlib.h>
#include <string.h>

#define CELL 512 /* bytes */
#define GAP  2
#define LEAST 4  /* a column is not made narrower than that */

void table_init(struct table *table, const struct table_column *columns, unsigned count)
{
	memset(table, 0, sizeof(*table));
	table->columns = columns;
	table->count = count;
}

void table_free(struct table *table)
{
	for (size_t i = 0; i < table->rows * table->count; i++)
		free(table->cells[i]);
	free(table->cells);
	table_init(table, table->columns, table->count);
}

bool table_add(struct table *table, const char *const *cells)
{
	if (table->rows == table->room) {
		size_t room = table->room ? 2 * table->room : 32;
		char **more = realloc(table->cells, room * table->count * sizeof(*more));

		if (!more)
			return false;
		table->cells = more;
		table->room = room;
	}
	for (unsigned i = 0; i < table->count; i++) {
		unsigned most = table->columns[i].most;
		char clean[CELL];

		text_clean(cells[i], strlen(cells[i]), most ? most : CELL, clean, sizeof(clean));
		table->cells[table->rows * table->count + i] = strdup(clean);
		if (!table->cells[table->rows * table->count + i]) {
			while (i-- > 0)
				free(table->cells[table->rows * table->count + i]);
			return false;
		}
	}
	table->rows++;
	return true;
}

static unsigned total(const struct table *table)
{
	unsigned sum = 0;

	for (unsigned i = 0; i < table->count; i++)
		if (table->shown[i])
			sum += table->width[i] + (sum ? GAP : 0);
	return sum;
}

static int to_drop(const struct table *table)
{
	int found = -1;

	for (unsigned i = 0; i < table->count; i++)
		if (table->shown[i] && table->columns[i].drop > 0 &&
		    (found < 0 || table->columns[i].drop > table->columns[found].drop))
			found = (int)i;
	return found;
}

static unsigned widest(const struct table *table)
{
	unsigned found = 0;

	for (unsigned i = 1; i < table->count; i++)
		if (table->shown[i] &&
		    (!table->shown[found] || table->width[i] > table->width[found]))
			found = i;
	return found;
}

void table_fit(struct table *table, unsigned columns)
{
	int drop;

	for (unsigned i = 0; i < table->count; i++) {
		table->shown[i] = true;
		table->width[i] = text_columns(table->columns[i].title);
		for (size_t row = 0; row < table->rows; row++) {
			unsigned width = text_columns(table->cells[row * table->count + i]);

			if (width > table->width[i])
				table->width[i] = width;
		}
		if (table->width[i] < table->least[i])
			table->width[i] = table->least[i];
		table->natural[i] = table->width[i];
	}
	if (columns == 0)
		return;
	while (total(table) > columns && (drop = to_drop(table)) >= 0)
		table->shown[drop] = false;
	while (total(table) > columns && table->width[widest(table)] > LEAST)
		table->width[widest(table)]--;
}

size_t table_line(const struct table *table, int row, char *line, size_t size)
{
	size_t len = 0, end = 0;

	for (unsigned i = 0; i < table->count; i++) {
		const char *cell = row < 0 ? table->columns[i].title
		                           : table->cells[(size_t)row * table->count + i];
		char cut[CELL];
		size_t pad, bytes;

		if (!table->shown[i])
			continue;
		pad = table->width[i] -
		      text_clean(cell, strlen(cell), table->width[i], cut, sizeof(cut));
		bytes = strlen(cut);
		if (len + GAP + pad + bytes >= size)
			break;
		if (len > 0) {
			memset(line + len, ' ', GAP);
			len += GAP;
		}
		if (table->columns[i].right) {
			memset(line + len, ' ', pad);
			len += pad;
		}
		memcpy(line + len, cut, bytes);
		len += bytes;
		if (bytes > 0)
			end = len;
		if (!table->columns[i].right) {
			memset(line + len, ' ', pad);
			len += pad;
		}
	}
	line[end] = '\0';
	return end;
}
