/* SPDX-License-Identifier: MIT */
/* What is wrong with the text of a configuration: collected, and shown at its keys. */
#pragma once

#include "src/config/read/rio.h"
#include "src/faces/show/json.h"

#define PROBLEMS (2 * (REPORT_MAX + 1)) /* a report passes on no more */

struct problem {
	bool error;
	int line, column; /* from 1; 0: of the text as a whole, or of the line */
	char *text;
};
struct problems {
	unsigned count;
	struct problem list[PROBLEMS];
};

/* A report that collects. Texts for which there is no memory are left out. */
struct config_report problems_report(struct problems *problems);
/* The words of the first error, and its line; "": there is none. */
const char *problems_first(const struct problems *problems, int *line);
/*
 * The array "problems". rio: the document that they are of, which knows the item, the block (by its
 * name for edits) and the key of a problem; NULL: nobody knows.
 */
void problems_json(struct json *json, const struct problems *problems, const struct rio *rio);
void problems_free(struct problems *problems);
