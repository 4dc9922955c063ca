/* SPDX-License-Identifier: MIT */
/* The signals that patterns select, as list and watch show them. */
#ifndef OWSCTL_ROWS_H
#define OWSCTL_ROWS_H

#include "reading.h"

struct row {
	int id; /* for ows_get(); right over ows_reopen() */
	char *name;
	char *path; /* NULL: a driver signal */
	bool output, fresh, alarm;
	/* what was seen last, see row_changed() */
	bool seen;
	uint8_t quality;
	int32_t err;
	uint64_t text_hash;
};
struct rows {
	struct row *row;
	int count;
};

/* Driver signals too if driver. 0 or -ENOMEM. Free with rows_free(). */
int rows_collect(struct ows *h, char *const *patterns, int pattern_count, bool driver,
                 struct rows *rows);
void rows_free(struct rows *rows);

/* Is value, quality or error another one than at the call before? */
bool row_changed(struct row *row, const struct reading *reading);

/* name, output, path and the like as members of a JSON object. */
void row_json(struct json *json, const struct row *row);

#endif
