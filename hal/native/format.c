/* SPDX-License-Identifier: MIT */
#include "hal/native/format.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

int extension_split(const char *text, size_t len, size_t *name_len)
{
	size_t dot = len;

	*name_len = len;
	while (dot > 0 && text[dot - 1] != '.' && text[dot - 1] != '/')
		dot--;
	if (dot == 0 || text[dot - 1] == '/' || dot == len)
		return EXTENSION_NONE;

	const char *word = text + dot;
	size_t n = len - dot;
	int element = 0;

	*name_len = dot - 1;
	if (n == 3 && strncasecmp(word, "ALL", 3) == 0)
		return EXTENSION_ALL;
	if (n == 4 && strncasecmp(word, "BYTE", 4) == 0)
		return EXTENSION_BYTE;
	if (n == 1 && isalpha((unsigned char)*word))
		return 256 + (toupper((unsigned char)*word) - 'A');
	for (size_t i = 0; i < n; i++) {
		if (n > 2 || !isdigit((unsigned char)word[i])) {
			*name_len = len;
			return EXTENSION_NONE;
		}
		element = element * 10 + (word[i] - '0');
	}
	return element;
}

bool extension_fits(const struct property *property, int extension)
{
	int first = property->array.index == INDEX_LETTERS ? 256 : 0;

	if (property->array.index == INDEX_NONE)
		return extension == EXTENSION_NONE;
	if (extension == EXTENSION_BYTE)
		return property->type == PROPERTY_BITS;
	if (extension == EXTENSION_ALL)
		return true;
	return extension >= first && extension < first + property->array.count;
}

int extension_print(const struct property *property, int extension, char text[8])
{
	if (property->array.index == INDEX_NONE || extension == EXTENSION_NONE) {
		text[0] = '\0';
		return 0;
	}
	if (extension == EXTENSION_ALL)
		return snprintf(text, 8, ".ALL");
	if (extension == EXTENSION_BYTE)
		return snprintf(text, 8, ".BYTE");
	if (property->array.index == INDEX_LETTERS)
		return snprintf(text, 8, ".%c", 'A' + (extension & 0x1f));
	return snprintf(text, 8, ".%d", extension & 0xff);
}

static int put(const char *from, int len, char *text, size_t room)
{
	if (len < 0 || (size_t)len > room)
		return -EMSGSIZE;
	memcpy(text, from, (size_t)len);
	return len;
}

static int format_date(double seconds, char *text, size_t room)
{
	time_t when = (time_t)seconds;
	struct tm tm;
	char out[40];

	if (!localtime_r(&when, &tm))
		return -EIO;
	return put(out, (int)strftime(out, sizeof(out), "%a %b %e %H:%M:%S %Y", &tm), text, room);
}

int format_number(uint8_t type, double number, char *text, size_t room)
{
	char out[32];

	switch ((enum property_type)type) {
	case PROPERTY_YESNO:
	case PROPERTY_BITS:
		return put(number != 0 ? "1" : "0", 1, text, room);
	case PROPERTY_UNSIGNED:
		return put(out, snprintf(out, sizeof(out), "%12lu", (unsigned long)number), text,
		           room);
	case PROPERTY_INTEGER:
		return put(out, snprintf(out, sizeof(out), "%12ld", (long)number), text, room);
	case PROPERTY_DATE:
		return format_date(number, text, room);
	case PROPERTY_FLOAT:
	case PROPERTY_PRESSURE:
	case PROPERTY_TEMPERATURE:
		return put(out, snprintf(out, sizeof(out), "%12G", number), text, room);
	case PROPERTY_DIRECTORY:
	case PROPERTY_ASCII:
	case PROPERTY_BINARY:
	case PROPERTY_ALIAS:
		break;
	}
	return -EIO;
}

static double element_of(const struct property *property, int element, const struct txn *txn)
{
	element &= 0xff;
	if (property->type == PROPERTY_BITS)
		return txn->bits >> element & 1;
	return txn->number[property->array.aggregate ? element : 0];
}

int format_value(const struct property *property, int extension, const struct txn *txn, char *text,
                 size_t room)
{
	size_t used = 0;

	if (extension == EXTENSION_NONE)
		return format_number(property->type, txn->number[0], text, room);
	if (extension == EXTENSION_BYTE)
		return format_number(PROPERTY_UNSIGNED, txn->bits, text, room);
	if (extension != EXTENSION_ALL)
		return format_number(property->type, element_of(property, extension, txn), text,
		                     room);
	for (int i = 0; i < property->array.count; i++) {
		if (i && used == room)
			return -EMSGSIZE;
		if (i)
			text[used++] = ',';
		int n = format_number(property->type, element_of(property, i, txn), text + used,
		                      room - used);
		if (n < 0)
			return n;
		used += (size_t)n;
	}
	return (int)used;
}

bool format_is_number(const struct property *property, int extension)
{
	switch ((enum property_type)property->type) {
	case PROPERTY_DIRECTORY:
	case PROPERTY_ASCII:
	case PROPERTY_BINARY:
	case PROPERTY_ALIAS:
	case PROPERTY_DATE:
		return false;
	case PROPERTY_FLOAT:
	case PROPERTY_INTEGER:
	case PROPERTY_PRESSURE:
	case PROPERTY_TEMPERATURE:
	case PROPERTY_UNSIGNED:
	case PROPERTY_YESNO:
	case PROPERTY_BITS:
		break;
	}
	return extension != EXTENSION_ALL;
}

double format_as_number(const struct property *property, int extension, const struct txn *txn)
{
	if (extension == EXTENSION_BYTE)
		return txn->bits;
	return extension == EXTENSION_NONE ? txn->number[0] : element_of(property, extension, txn);
}

static int parse_yesno(const char *text, double *number)
{
	static const struct {
		const char *word;
		double value;
	} words[] = {{"yes", 1}, {"y", 1}, {"on", 1}, {"no", 0}, {"n", 0}, {"off", 0}};
	char *end;
	long value = strtol(text, &end, 10);

	if (end != text) {
		*number = value != 0;
		return 0;
	}
	while (isspace((unsigned char)*text))
		text++;
	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++) {
		size_t n = strlen(words[i].word);

		if (strncasecmp(text, words[i].word, n) == 0 && !isalnum((unsigned char)text[n])) {
			*number = words[i].value;
			return 0;
		}
	}
	return -EINVAL;
}

static int parse_date(const char *text, double *number)
{
	static const char *const forms[] = {"%a %b %d %H:%M:%S %Y", "%b %d %Y %H:%M:%S",
	                                    "%b %d %H:%M:%S %Y", "%Y-%m-%d %H:%M:%S"};

	for (size_t i = 0; i < sizeof(forms) / sizeof(forms[0]); i++) {
		struct tm tm = {.tm_isdst = -1};

		if (!strptime(text, forms[i], &tm))
			continue;
		tm.tm_isdst = -1;
		*number = (double)mktime(&tm);
		return *number < 0 ? -EINVAL : 0;
	}
	return -EINVAL;
}

static int parse_number(uint8_t type, const char *text, size_t len, double *number)
{
	char copy[64], *end;

	if (len >= sizeof(copy))
		return -EINVAL;
	memcpy(copy, text, len);
	copy[len] = '\0';
	errno = 0;
	switch ((enum property_type)type) {
	case PROPERTY_YESNO:
	case PROPERTY_BITS:
		return parse_yesno(copy, number);
	case PROPERTY_DATE:
		return parse_date(copy, number);
	case PROPERTY_UNSIGNED:
	case PROPERTY_INTEGER: {
		long long value = strtoll(copy, &end, 10);
		*number = type == PROPERTY_UNSIGNED ? (double)(uint32_t)value
		                                    : (double)(int32_t)value;
		if (value > UINT32_MAX || value < INT32_MIN)
			return -EINVAL;
		break;
	}
	case PROPERTY_FLOAT:
	case PROPERTY_PRESSURE:
	case PROPERTY_TEMPERATURE:
		*number = strtod(copy, &end);
		if (!isfinite(*number))
			return -EINVAL;
		break;
	case PROPERTY_DIRECTORY:
	case PROPERTY_ASCII:
	case PROPERTY_BINARY:
	case PROPERTY_ALIAS:
		return -EINVAL;
	}
	return end == copy || errno ? -EINVAL : 0;
}

static void set_element(const struct property *property, int element, double number,
                        struct txn *txn)
{
	uint32_t bit = UINT32_C(1) << (element & 0x1f);

	if (property->type == PROPERTY_BITS)
		txn->bits = number != 0 ? txn->bits | bit : txn->bits & ~bit;
	else
		txn->number[property->array.aggregate ? element & 0xff : 0] = number;
}

int parse_value(const struct property *property, int extension, const char *text, size_t len,
                struct txn *txn)
{
	const char *part;
	size_t part_len;
	double number;
	int err;

	if (extension == EXTENSION_BYTE) {
		err = parse_number(PROPERTY_UNSIGNED, text, len, &number);
		if (!err)
			txn->bits = (uint32_t)number & ((UINT32_C(1) << property->array.count) - 1);
		return err;
	}
	if (extension != EXTENSION_ALL) {
		err = parse_number(property->type, text, len, &number);
		if (!err)
			set_element(property, extension == EXTENSION_NONE ? 0 : extension, number,
			            txn);
		return err;
	}
	if (list_count(text, len) != property->array.count)
		return -EINVAL;
	for (int i = 0; i < property->array.count; i++) {
		if (!list_part(text, len, (unsigned)i, &part, &part_len))
			return -EINVAL;
		err = parse_number(property->type, part, part_len, &number);
		if (err)
			return err;
		set_element(property, i, number, txn);
	}
	return 0;
}

bool list_part(const char *text, size_t len, unsigned n, const char **part, size_t *part_len)
{
	const char *end = text + len;

	for (;; n--) {
		const char *comma = memchr(text, ',', (size_t)(end - text));

		if (n == 0) {
			*part = text;
			*part_len = (size_t)((comma ? comma : end) - text);
			return true;
		}
		if (!comma)
			return false;
		text = comma + 1;
	}
}

unsigned list_count(const char *text, size_t len)
{
	unsigned count = 1;

	for (size_t i = 0; i < len; i++)
		count += text[i] == ',';
	return count;
}
