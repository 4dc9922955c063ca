/* SPDX-License-Identifier: MIT */
/* Words, numbers and names of a line of a table of sensors; reasons with file and line. */
#pragma once

#include "hal/chips/bridges/sensor.h"

#define SENSOR_LINE 400

struct sensor_reader {
	struct sensor_table *table;
	const char *name;
	unsigned line;
	const char *at;                      /* in the line */
	uint32_t checked[SENSOR_BYTES / 32]; /* bytes of this kind that a checksum covers */
	uint32_t lone[SENSOR_BYTES / 32];    /* ... that were read without a register */
	int64_t wait_ns;                     /* that this kind waits in all */
	char *why;
	size_t why_size;
};

/* Returns -EINVAL. */
int __attribute__((format(printf, 2, 3)))
reader_fail(struct sensor_reader *r, const char *format, ...);
/* The kind of sensor that is being read. */
struct sensor_kind *reader_kind(const struct sensor_reader *r);
/*
 * The next line of the text to line, and r->at to its beginning. Lines end with LF, CR or both; a
 * comment is no part of them.
 */
int reader_line(struct sensor_reader *r, const char **text, char line[SENSOR_LINE]);
void reader_skip(struct sensor_reader *r);
/* Is this the next word? Then it is taken. */
bool reader_take(struct sensor_reader *r, const char *word);
bool reader_ended(struct sensor_reader *r);
int reader_whole(struct sensor_reader *r, unsigned least, unsigned most, unsigned *number);
int reader_real(struct sensor_reader *r, double *number);
int reader_name(struct sensor_reader *r, char out[FORMULA_NAME]);
int reader_equals(struct sensor_reader *r);
/* LOW to HIGH */
int reader_range(struct sensor_reader *r, double *low, double *high);
/* set: it may use $. The reason of an error has the formula. */
int reader_formula(struct sensor_reader *r, bool set, struct formula *out);
