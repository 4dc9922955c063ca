/* SPDX-License-Identifier: MIT */
/* Whether the type of a signal fits its property, by what /structure of the target says of it. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "src/daemon/engine/structure.h"

struct wanted {
	struct structure_check check;
	uint32_t row;
};

static int compare_wanted(const void *a, const void *b)
{
	const struct wanted *x = a, *y = b;
	int order = strcmp(x->check.path, y->check.path);

	return order ? order : (x->row > y->row) - (x->row < y->row);
}

static bool check_path(const char *path, char *out, size_t size)
{
	struct path p;
	int n;

	if (path_split(path, strlen(path), &p) || !p.has_rom || !p.property.len)
		return false;
	n = snprintf(out, size, "/structure/%02X/%.*s", p.rom[0], (int)p.property.len,
	             p.property.text);
	return n > 0 && (size_t)n < size;
}

int structure_init(struct structure *structure, const struct table *table)
{
	struct wanted *wanted = calloc((size_t)table->count + 1, sizeof(*wanted));
	uint32_t n = 0;

	*structure = (struct structure){0};
	structure->checks = calloc((size_t)table->count + 1, sizeof(*structure->checks));
	structure->rows = calloc((size_t)table->count + 1, sizeof(*structure->rows));
	structure->check_of = calloc((size_t)table->count + 1, sizeof(*structure->check_of));
	if (!wanted || !structure->checks || !structure->rows || !structure->check_of) {
		free(wanted);
		structure_free(structure);
		return -ENOMEM;
	}
	for (uint32_t row = 0; row < table->count; row++) {
		structure->check_of[row] = STRUCTURE_NONE;
		if (!check_path(table->signals[row].item->path, wanted[n].check.path,
		                sizeof(wanted[n].check.path)))
			continue;
		wanted[n++].row = row;
	}
	qsort(wanted, n, sizeof(*wanted), compare_wanted);
	for (uint32_t i = 0; i < n; i++) {
		if (i == 0 || strcmp(wanted[i - 1].check.path, wanted[i].check.path) != 0) {
			structure->checks[structure->count] = wanted[i].check;
			structure->checks[structure->count++].first = i;
		}
		structure->checks[structure->count - 1].count++;
		structure->rows[i] = wanted[i].row;
		structure->check_of[wanted[i].row] = structure->count - 1;
	}
	free(wanted);
	return 0;
}

void structure_free(struct structure *structure)
{
	free(structure->checks);
	free(structure->rows);
	free(structure->check_of);
	*structure = (struct structure){0};
}

/* strchr() would find the NUL at the end too. */
static bool one_of(const char *set, char c)
{
	return c && strchr(set, c);
}

int structure_parse(const char *text, size_t len, struct structure_entry *entry)
{
	char copy[64], *end;

	if (len < 20 || len >= sizeof(copy))
		return -EILSEQ;
	memcpy(copy, text, len);
	copy[len] = '\0';
	if (copy[1] != ',' || !one_of("yiuftgpabdlDv", copy[0]))
		return -EILSEQ;
	entry->type = copy[0];
	entry->index = strtol(copy + 2, &end, 10);
	if (*end != ',')
		return -EILSEQ;
	strtol(end + 1, &end, 10);
	if (*end != ',' || !one_of("rwo", end[1]) || !one_of("rwo", end[2]) || end[3] != ',')
		return -EILSEQ;
	entry->access[0] = end[1];
	entry->access[1] = end[2];
	entry->access[2] = '\0';
	return 0;
}

int structure_fault(const struct structure_entry *entry, const struct config_item *item,
                    const char **why)
{
	int err = 0;

	*why = "";
	if (entry->type == 'D') {
		err = -EISDIR;
		*why = "it is a directory, not a property";
	} else if (item->type != OWS_STRING && entry->index == -1) {
		err = -EPROTOTYPE;
		*why = "it is a list (.ALL): Type has to be string";
	} else if (item->type != OWS_STRING && strchr("abdl", entry->type)) {
		err = -EPROTOTYPE;
		*why = "it is text: Type has to be string";
	} else if (item->output && strcmp(entry->access, "ro") == 0) {
		err = -EACCES;
		*why = "it is read-only: IO has to be input";
	} else if (item->readable && strcmp(entry->access, "wo") == 0) {
		err = -EACCES;
		*why = "it is write-only: IO has to be output, without Readable";
	}
	return err;
}
