/* SPDX-License-Identifier: MIT */
/* Words, numbers and names of a line of a table of sensors. */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/bridges/sensor_reader.h"

int reader_fail(struct sensor_reader *r, const char *format, ...)
{
	char reason[160];
	va_list args;

	va_start(args, format);
	vsnprintf(reason, sizeof(reason), format, args);
	va_end(args);
	snprintf(r->why, r->why_size, "%s:%u: %s", r->name, r->line, reason);
	return -EINVAL;
}

struct sensor_kind *reader_kind(const struct sensor_reader *r)
{
	return &r->table->kinds[r->table->kind_count - 1];
}

int reader_line(struct sensor_reader *r, const char **text, char line[SENSOR_LINE])
{
	size_t all = strcspn(*text, "\r\n"), n = strcspn(*text, "#\r\n");

	r->line++;
	r->at = line;
	line[0] = '\0';
	if (n >= SENSOR_LINE)
		return reader_fail(r, "a line of more than %d characters", SENSOR_LINE - 1);
	memcpy(line, *text, n);
	line[n] = '\0';
	*text += all;
	*text += (*text)[0] == '\r' && (*text)[1] == '\n' ? 2 : (*text)[0] != '\0';
	return 0;
}

void reader_skip(struct sensor_reader *r)
{
	r->at += strspn(r->at, " \t");
}

/* Is this the next word? Then it is taken. */
bool reader_take(struct sensor_reader *r, const char *word)
{
	size_t n = strlen(word);

	reader_skip(r);
	if (strncmp(r->at, word, n) != 0 || !strchr(" \t=", r->at[n]))
		return false;
	r->at += n;
	return true;
}

/* strchr() finds the end of the text too. */
bool reader_ended(struct sensor_reader *r)
{
	reader_skip(r);
	return *r->at == '\0';
}

int reader_whole(struct sensor_reader *r, unsigned least, unsigned most, unsigned *number)
{
	char *end;
	unsigned long value;

	reader_skip(r);
	value = strtoul(r->at, &end, 0);
	if (end == r->at || *r->at == '-' || !strchr(" \t", *end) || value < least || value > most)
		return reader_fail(r, "expected a number from %u to %u at \"%.24s\"", least, most,
		                   r->at);
	r->at = end;
	*number = (unsigned)value;
	return 0;
}

int reader_real(struct sensor_reader *r, double *number)
{
	char *end;

	reader_skip(r);
	*number = strtod(r->at, &end);
	if (end == r->at || !strchr(" \t", *end) || !isfinite(*number))
		return reader_fail(r, "expected a number at \"%.24s\"", r->at);
	r->at = end;
	return 0;
}

/* A name of letters, digits and _ that begins with a letter. */
int reader_name(struct sensor_reader *r, char out[FORMULA_NAME])
{
	static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
				      "_0123456789";
	size_t n;

	reader_skip(r);
	n = strspn(r->at, letters);
	if (n == 0 || n >= FORMULA_NAME || !strchr(" \t=", r->at[n]) ||
	    (*r->at >= '0' && *r->at <= '9') || *r->at == '_')
		return reader_fail(r, "expected a name of at most %d letters at \"%.24s\"",
		                   FORMULA_NAME - 1, r->at);
	memcpy(out, r->at, n);
	out[n] = '\0';
	r->at += n;
	return 0;
}

int reader_equals(struct sensor_reader *r)
{
	reader_skip(r);
	if (*r->at != '=')
		return reader_fail(r, "expected = at \"%.24s\"", r->at);
	r->at++;
	return 0;
}

int reader_range(struct sensor_reader *r, double *low, double *high)
{
	int err = reader_real(r, low);

	if (!err)
		err = reader_take(r, "to") ? reader_real(r, high) : reader_fail(r, "expected to");
	return err || *low < *high ? err : reader_fail(r, "a range that is empty");
}

int reader_formula(struct sensor_reader *r, bool set, struct formula *out)
{
	const struct sensor_kind *kind = reader_kind(r);
	const struct formula_scope scope = {.bytes = kind->bytes,
	                                    .names = kind->names,
	                                    .name_count = kind->name_count,
	                                    .set = set};
	char reason[80];
	int err;

	reader_skip(r);
	const char *begin = r->at;
	err = formula_parse(&r->table->pool, &scope, &r->at, out, reason, sizeof(reason));
	return err == -EINVAL ? reader_fail(r, "%s, in the formula \"%.40s\"", reason, begin) : err;
}
