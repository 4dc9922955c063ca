/* SPDX-License-Identifier: MIT */
/* Values of properties as texts, and back: what a device shall be given has to fit its property. */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "hal/chips/format.h"
#include "hal/chips/loggers/host_clock.h"

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
		return EXTENSION_LETTERS + (toupper((unsigned char)*word) - 'A');
	for (size_t i = 0; i < n; i++) {
		if (n > 4 || !isdigit((unsigned char)word[i]))
			return EXTENSION_WORD;
		element = element * 10 + (word[i] - '0');
	}
	return element;
}

bool extension_fits(const struct property *property, int extension)
{
	int first = property->array.index == INDEX_LETTERS ? EXTENSION_LETTERS : 0;

	if (property->array.index == INDEX_NONE)
		return extension == EXTENSION_NONE;
	if (property->array.count == 0)
		return first ? extension >= 0 || extension == EXTENSION_WORD
		             : extension >= 0 && extension < EXTENSION_LETTERS;
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
	if (property->array.count == 0)
		return snprintf(text, 8, property->array.index == INDEX_LETTERS ? ".xxx" : ".000");
	if (property->array.index == INDEX_LETTERS)
		return snprintf(text, 8, ".%c", 'A' + (extension & 0x1f));
	return snprintf(text, 8, ".%d", extension_element(extension));
}

static int format_put(const char *from, int len, char *text, size_t room)
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
	return format_put(out, (int)strftime(out, sizeof(out), "%a %b %e %H:%M:%S %Y", &tm), text,
	                  room);
}

int format_number(uint8_t type, double number, char *text, size_t room)
{
	char out[32];

	switch (property_form(type)) {
	case FORM_YESNO:
		return format_put(number != 0 ? "1" : "0", 1, text, room);
	case FORM_WHOLE:
		if (type == PROPERTY_UNSIGNED && number >= 0)
			return format_put(
				out, snprintf(out, sizeof(out), "%12lu", (unsigned long)number),
				text, room);
		return format_put(out, snprintf(out, sizeof(out), "%12ld", (long)number), text,
		                  room);
	case FORM_DATE:
		return format_date(number, text, room);
	case FORM_DECIMAL:
		return format_put(out, snprintf(out, sizeof(out), "%12G", number), text, room);
	case FORM_NONE:
	case FORM_TEXT:
		break;
	}
	return -EIO;
}

static double element_of(const struct property *property, int element, const struct txn *txn)
{
	element = extension_element(element);
	if (property->type == PROPERTY_BITS)
		return txn->bits >> element & 1;
	return txn->number[property->array.aggregate ? element : 0];
}

int format_alone(const struct property *property, int extension, double number, char *text,
                 size_t room)
{
	return format_number(extension == EXTENSION_BYTE ? PROPERTY_UNSIGNED : property->type,
	                     number, text, room);
}

int format_value(const struct property *property, int extension, const struct txn *txn, char *text,
                 size_t room)
{
	size_t used = 0;

	if (extension != EXTENSION_ALL)
		return format_alone(property, extension, format_as_number(property, extension, txn),
		                    text, room);
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
	return property_form(property->type) >= FORM_YESNO && extension != EXTENSION_ALL;
}

double format_as_number(const struct property *property, int extension, const struct txn *txn)
{
	if (extension == EXTENSION_BYTE)
		return txn->bits;
	return extension == EXTENSION_NONE ? txn->number[0] : element_of(property, extension, txn);
}

static int parse_word(const char *text, double *number)
{
	static const struct {
		const char *word;
		double value;
	} words[] = {{"yes", 1}, {"y", 1}, {"on", 1}, {"no", 0}, {"n", 0}, {"off", 0}};

	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
		if (strcasecmp(text, words[i].word) == 0) {
			*number = words[i].value;
			return 0;
		}
	return -EINVAL;
}

static int parse_date(const char *text, double *number)
{
	static const char *const forms[] = {"%a %b %d %H:%M:%S %Y", "%b %d %Y %H:%M:%S",
	                                    "%b %d %H:%M:%S %Y", "%Y-%m-%d %H:%M:%S"};

	for (size_t i = 0; i < sizeof(forms) / sizeof(forms[0]); i++) {
		struct tm tm = {.tm_isdst = -1};
		const char *end = strptime(text, forms[i], &tm);

		if (!end || *end)
			continue;
		tm.tm_isdst = -1;
		*number = (double)mktime(&tm);
		return *number < 0 || *number > UINT32_MAX ? -EINVAL : 0;
	}
	return -EINVAL;
}

int text_decimal(const char *text, double *number)
{
	char *end;

	if (text[strspn(text, "+-.0123456789eE")])
		return -EINVAL;
	errno = 0;
	*number = strtod(text, &end);
	return end == text || *end || errno ? -EINVAL : 0;
}

size_t text_end(const char *text, size_t len)
{
	while (len && (isspace((unsigned char)text[len - 1]) || text[len - 1] == '\0'))
		len--;
	return len;
}

bool text_trimmed(const char *text, size_t len, char copy[TEXT_ROOM])
{
	len = text_end(text, len);
	while (len && isspace((unsigned char)*text)) {
		text++;
		len--;
	}
	if (len == 0 || len >= TEXT_ROOM || memchr(text, '\0', len))
		return false;
	memcpy(copy, text, len);
	copy[len] = '\0';
	return true;
}

/* The last digit of the number is measured by the last of the limits. */
static bool digits_fit(uint32_t limits, double number)
{
	for (uint32_t rest = (uint32_t)number; rest; rest /= 10, limits /= 10)
		if (rest % 10 > limits % 10)
			return false;
	return true;
}

static bool is_whole_between(double number, double least, double most)
{
	return number == trunc(number) && number >= least && number <= most;
}

static bool takes(const struct property *property, int extension, double number)
{
	if (extension == EXTENSION_BYTE)
		return is_whole_between(number, 0, ldexp(1, property->array.count) - 1);
	switch (property_form(property->type)) {
	case FORM_YESNO:
		return is_whole_between(number, 0, 1);
	case FORM_WHOLE:
		if (property->type == PROPERTY_INTEGER)
			return is_whole_between(number, INT32_MIN, INT32_MAX);
		return is_whole_between(number, property->negative ? INT32_MIN : 0, UINT32_MAX) &&
		       (!property->digits || digits_fit(property->digits, number));
	case FORM_DECIMAL:
		return isfinite(number);
	case FORM_NONE:
	case FORM_TEXT:
	case FORM_DATE:
		break;
	}
	return false;
}

static int parse_text(const struct property *property, int extension, const char *text, size_t len,
                      double *number)
{
	char copy[TEXT_ROOM];

	if (!text_trimmed(text, len, copy)) {
		/* An empty date is the present time, as in OWFS: so clocks are set by scripts. */
		bool now = property->type == PROPERTY_DATE && text_end(text, len) == 0;

		return now ? host_clock(number) : -EINVAL;
	}
	if (property->type == PROPERTY_DATE)
		return parse_date(copy, number);
	if (property_form(property->type) == FORM_YESNO && extension != EXTENSION_BYTE &&
	    parse_word(copy, number) == 0)
		return 0;
	return text_decimal(copy, number) || !takes(property, extension, *number) ? -EINVAL : 0;
}

static void set_element(const struct property *property, int element, double number,
                        struct txn *txn)
{
	uint32_t bit = UINT32_C(1) << (element & 0x1f);

	if (element == EXTENSION_BYTE)
		txn->bits = (uint32_t)number;
	else if (property->type == PROPERTY_BITS)
		txn->bits = number != 0 ? txn->bits | bit : txn->bits & ~bit;
	else
		txn->number[property->array.aggregate ? extension_element(element) : 0] = number;
}

int take_number(const struct property *property, int extension, double number, struct txn *txn)
{
	if (!takes(property, extension, number))
		return -EINVAL;
	set_element(property, extension, number, txn);
	return 0;
}

int parse_value(const struct property *property, int extension, const char *text, size_t len,
                struct txn *txn)
{
	const char *part;
	size_t part_len;
	double number;
	int err;

	if (extension != EXTENSION_ALL) {
		err = parse_text(property, extension, text, len, &number);
		if (!err)
			set_element(property, extension, number, txn);
		return err;
	}
	if (!list_fits(property, text, len))
		return -EINVAL;
	for (int i = 0; i < property->array.count; i++)
		if (list_part(text, len, (unsigned)i, &part, &part_len) &&
		    parse_text(property, i, part, part_len, &number) == 0)
			set_element(property, i, number, txn);
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

bool list_fits(const struct property *property, const char *text, size_t len)
{
	const char *part;
	size_t part_len;
	double number;
	unsigned n = 0;

	for (; list_part(text, len, n, &part, &part_len); n++)
		if (n == property->array.count ||
		    parse_text(property, (int)n, part, part_len, &number))
			return false;
	return n == property->array.count;
}

bool format_takes(const struct property *property, int extension, const char *text, size_t len)
{
	double number;

	return extension == EXTENSION_ALL ? list_fits(property, text, len)
	                                  : !parse_text(property, extension, text, len, &number);
}
