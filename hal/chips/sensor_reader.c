/* SPDX-License-Identifier: MIT */
/* Words, numbers and names of a line of a table of sensors. */
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/sensor_reader.h"

int reader_fail(struct sensor_reader *r, const char *format, ...)
{
	char reason[120];
	va_list args;

	va_start(args, format);
	vsnprintf(reason, sizeof(reason), format, args);
	va_end(args);
	snprintf(r->why, r->why_size, "%s:%u: %s", r->name, r->line, reason);
	return -EINVAL;
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
	if (end == r->at || !strchr(" \t", *end))
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
