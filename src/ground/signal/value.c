/* SPDX-License-Identifier: MIT */
/* Values of signals: their types, and how texts and numbers become values and values texts. */
#include <errno.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "src/ground/signal/value.h"

/* The limits of each integer type; float and double have those of the C types. */
static const struct type_def {
	const char *name;
	int64_t least, most;
} types[] = {
	[OWS_BOOL] = {"bool", 0, 1},
	[OWS_BYTE] = {"byte", 0, UINT8_MAX},
	[OWS_SHORT] = {"short", INT16_MIN, INT16_MAX},
	[OWS_LONG] = {"long", INT32_MIN, INT32_MAX},
	[OWS_WORD] = {"word", 0, UINT16_MAX},
	[OWS_DWORD] = {"dword", 0, UINT32_MAX},
	[OWS_FLOAT] = {"float", 0, 0},
	[OWS_DOUBLE] = {"double", 0, 0},
	[OWS_LARGE] = {"large", INT64_MIN, INT64_MAX},
	[OWS_STRING] = {"string", 0, 0},
};
#define TYPE_SLOTS ((int)(sizeof(types) / sizeof(types[0])))

bool value_type_ok(int type)
{
	return type >= 0 && type < TYPE_SLOTS && types[type].name;
}

bool value_is_float(enum ows_type type)
{
	return type == OWS_FLOAT || type == OWS_DOUBLE;
}

const char *value_type_name(enum ows_type type)
{
	return value_type_ok((int)type) ? types[type].name : "?";
}

int value_type_parse(const char *name)
{
	for (int i = 0; i < TYPE_SLOTS; i++)
		if (types[i].name && !strcmp(types[i].name, name))
			return i;
	return -1;
}

static bool is_number(enum ows_type type)
{
	return value_type_ok((int)type) && type != OWS_STRING;
}

int64_t value_of_double(double number)
{
	int64_t bits;

	memcpy(&bits, &number, sizeof(bits));
	return bits;
}

static double double_of(int64_t bits)
{
	double number;

	memcpy(&number, &bits, sizeof(number));
	return number;
}

double value_number(enum ows_type type, int64_t value)
{
	return value_is_float(type) ? double_of(value) : (double)value;
}

/* --- Decimal text ------------------------------------------------------------------------- */

/*
 * A decimal number as written: 0.DIGITS times ten to the power of point. Integers are rounded on
 * the digits, exactly; a double is made from digits and exponent without a decimal point, so that
 * the locale does not matter.
 */
#define DIGITS_MAX 400
struct decimal {
	bool negative;
	int count; /* of digits, without leading zeros; 0: the number is zero */
	int point;
	char digits[DIGITS_MAX];
};

#define POINT_FAR 100000 /* beyond every type, and far from INT_MAX */

static bool is_blank(char c)
{
	return c == ' ' || (c >= '\t' && c <= '\r');
}

static bool is_digit(char c)
{
	return c >= '0' && c <= '9';
}

static void trim_blanks(const char **text, size_t *len)
{
	while (*len && is_blank(**text)) {
		++*text;
		--*len;
	}
	while (*len && is_blank((*text)[*len - 1]))
		--*len;
}

static int exponent_parse(const char *p, const char *end, int *exponent)
{
	bool negative = false;
	int sum = 0;

	if (p < end && (*p == '+' || *p == '-'))
		negative = *p++ == '-';
	if (p == end)
		return -EILSEQ;
	for (; p < end; p++) {
		if (!is_digit(*p))
			return -EILSEQ;
		if (sum < POINT_FAR)
			sum = sum * 10 + (*p - '0');
	}
	*exponent = negative ? -sum : sum;
	return 0;
}

static int decimal_parse(const char *text, size_t len, struct decimal *d)
{
	const char *p = text, *end = text + len;
	bool seen = false, fraction = false;
	int exponent = 0;

	d->negative = false;
	d->count = d->point = 0;
	if (len > DIGITS_MAX)
		return -EILSEQ;
	if (p < end && (*p == '+' || *p == '-'))
		d->negative = *p++ == '-';
	for (; p < end && (is_digit(*p) || (*p == '.' && !fraction)); p++) {
		if (*p == '.') {
			fraction = true;
			continue;
		}
		seen = true;
		if (*p != '0' || d->count > 0) {
			d->digits[d->count++] = *p;
			d->point += !fraction;
		} else {
			d->point -= fraction;
		}
	}
	if (!seen)
		return -EILSEQ;
	if (p < end) {
		if (*p != 'e' && *p != 'E')
			return -EILSEQ;
		if (exponent_parse(p + 1, end, &exponent))
			return -EILSEQ;
	}
	d->point += exponent;
	return 0;
}

/* Exponents stay short: the digits are at most 400, the point at most about 1.1 million. */
static void decimal_print(const struct decimal *d, char text[DIGITS_MAX + 16])
{
	char *p = text;

	if (d->negative)
		*p++ = '-';
	if (!d->count)
		*p++ = '0';
	memcpy(p, d->digits, (size_t)d->count);
	snprintf(p + d->count, 14, "e%d", d->count ? d->point - d->count : 0);
}

/*
 * What sensors say is short. Its digits as a whole number and a power of ten up to 22 are exact as
 * doubles, so that one division rounds it right, where the machine computes with no more bits.
 */
static double short_number(const struct decimal *d)
{
	double number = 0, power = 1;

	for (int i = 0; i < d->count; i++)
		number = number * 10 + (d->digits[i] - '0');
	for (int i = d->point; i < d->count; i++)
		power *= 10;
	return (d->negative ? -number : number) / power;
}

static double decimal_number(enum ows_type type, const struct decimal *d)
{
	int fraction = d->count - d->point;
	char text[DIGITS_MAX + 16];

	if (type != OWS_FLOAT && FLT_EVAL_METHOD == 0 && d->count <= DBL_DIG && fraction >= 0 &&
	    fraction <= 22)
		return short_number(d);
	decimal_print(d, text);
	/* a float is not parsed as a double first: that would round twice */
	return type == OWS_FLOAT ? (double)strtof(text, NULL) : strtod(text, NULL);
}

/*
 * The integer part. Returns 0, or -1 or 1 when it lies below or above the type (*value is then the
 * limit). *exact: there was no fraction.
 */
static int decimal_integer(const struct decimal *d, enum ows_type type, int64_t *value, bool *exact)
{
	const uint64_t cap = d->negative ? (uint64_t)INT64_MAX + 1 : INT64_MAX;
	uint64_t sum = 0;
	bool over = false;

	*exact = true;
	for (int i = 0; i < d->point && !over; i++) {
		uint64_t digit = i < d->count ? (uint64_t)(d->digits[i] - '0') : 0;

		if (!d->count)
			break;
		over = sum > (cap - digit) / 10;
		if (!over)
			sum = sum * 10 + digit;
	}
	for (int i = d->point > 0 ? d->point : 0; i < d->count && *exact; i++)
		*exact = d->digits[i] == '0';
	if (!over)
		*value = d->negative ? (int64_t)(0 - sum) : (int64_t)sum;
	if (d->negative && (over || *value < types[type].least)) {
		*value = types[type].least;
		return -1;
	}
	if (!d->negative && (over || *value > types[type].most)) {
		*value = types[type].most;
		return 1;
	}
	return 0;
}

/* --- From a bus --------------------------------------------------------------------------- */

static uint8_t quality_of_side(int side)
{
	return side < 0 ? OWS_Q_LOW : side > 0 ? OWS_Q_HIGH : OWS_Q_GOOD;
}

static int side_of_infinity(double number)
{
	return !isinf(number) ? 0 : number < 0 ? -1 : 1;
}

static int64_t float_held(enum ows_type type, double number, int side)
{
	const double most = type == OWS_FLOAT ? (double)FLT_MAX : DBL_MAX;

	return value_of_double(side ? side * most : number);
}

int value_from_text(enum ows_type type, const char *text, size_t len, int64_t *value,
                    uint8_t *quality)
{
	struct decimal d;
	double number;
	bool exact;
	int side;

	trim_blanks(&text, &len);
	if (!is_number(type))
		return -EINVAL;
	if (decimal_parse(text, len, &d))
		return -EILSEQ;
	if (value_is_float(type)) {
		number = decimal_number(type, &d);
		side = side_of_infinity(number);
		*value = float_held(type, number, side);
	} else {
		side = decimal_integer(&d, type, value, &exact);
		if (!exact)
			return -EILSEQ;
		if (type == OWS_BOOL && side > 0) /* any number above zero is true */
			side = 0;
	}
	*quality = quality_of_side(side);
	return 0;
}

int value_from_number(enum ows_type type, double number, int64_t *value, uint8_t *quality)
{
	int side = 0;

	if (!is_number(type))
		return -EINVAL;
	if (!isfinite(number))
		return -EILSEQ;
	if (type == OWS_FLOAT)
		number = (double)(float)number;
	if (value_is_float(type)) {
		side = side_of_infinity(number);
		*value = float_held(type, number, side);
	} else {
		if (number != trunc(number))
			return -EILSEQ;
		/* the limit of large itself is no double: 2^63 is the first one outside */
		if (number < (double)types[type].least) {
			side = -1;
			*value = types[type].least;
		} else if (number > (double)types[type].most || number >= 0x1p63) {
			side = type != OWS_BOOL;
			*value = types[type].most;
		} else {
			*value = (int64_t)number;
		}
	}
	*quality = quality_of_side(side);
	return 0;
}

/* --- From a control program --------------------------------------------------------------- */

int value_set_integer(enum ows_type type, int64_t number, int64_t *value)
{
	if (!is_number(type))
		return -EINVAL;
	if (value_is_float(type))
		return value_set_double(type, (double)number, value);
	if (number < types[type].least || number > types[type].most)
		return -ERANGE;
	*value = number;
	return 0;
}

int value_set_double(enum ows_type type, double number, int64_t *value)
{
	if (!is_number(type) || !isfinite(number))
		return -EINVAL;
	if (type == OWS_FLOAT)
		number = (double)(float)number;
	if (isinf(number))
		return -ERANGE;
	if (value_is_float(type)) {
		*value = value_of_double(number);
		return 0;
	}
	if (number != trunc(number) || number < -0x1p63 || number >= 0x1p63)
		return -ERANGE;
	return value_set_integer(type, (int64_t)number, value);
}

bool value_holds(enum ows_type type, int64_t value)
{
	if (type == OWS_FLOAT)
		return isfinite((float)double_of(value));
	if (type == OWS_DOUBLE)
		return isfinite(double_of(value));
	return is_number(type) && value >= types[type].least && value <= types[type].most;
}

static int word_of_bool(const char *text, size_t len)
{
	static const char *const words[][2] = {{"off", "on"}, {"no", "yes"}, {"false", "true"}};

	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
		for (int yes = 0; yes < 2; yes++)
			if (strlen(words[i][yes]) == len && !strncasecmp(words[i][yes], text, len))
				return yes;
	return -1;
}

int value_parse(enum ows_type type, const char *text, int64_t *value)
{
	size_t len = strlen(text);
	struct decimal d;
	int64_t parsed;
	double number;
	bool exact;
	int word;

	trim_blanks(&text, &len);
	if (!is_number(type))
		return -EINVAL;
	word = type == OWS_BOOL ? word_of_bool(text, len) : -1;
	if (word >= 0) {
		*value = word;
		return 0;
	}
	if (decimal_parse(text, len, &d))
		return -EINVAL;
	if (value_is_float(type)) {
		number = decimal_number(type, &d);
		if (isinf(number))
			return -ERANGE;
		*value = value_of_double(number);
		return 0;
	}
	if (decimal_integer(&d, type, &parsed, &exact))
		return -ERANGE;
	if (!exact)
		return -EINVAL;
	*value = parsed;
	return 0;
}

/* --- To text ------------------------------------------------------------------------------ */

/*
 * printf prints the locale's decimal point: every byte that is no part of a C number becomes a dot.
 */
static int print_digits(double number, int digits, char text[VALUE_TEXT_MAX])
{
	char raw[64];
	int n = 0;

	snprintf(raw, sizeof(raw), "%.*g", digits, number);
	for (const char *p = raw; *p && n < VALUE_TEXT_MAX - 1; p++) {
		if (is_digit(*p) || *p == '-' || *p == '+' || *p == 'e')
			text[n++] = *p;
		else if (n && text[n - 1] != '.')
			text[n++] = '.';
	}
	text[n] = '\0';
	return n;
}

static bool reads_back(enum ows_type type, const char *text, size_t len, double number)
{
	struct decimal d;

	return decimal_parse(text, len, &d) == 0 &&
	       decimal_number(type, &d) == (type == OWS_FLOAT ? (double)(float)number : number);
}

int value_to_text(enum ows_type type, int64_t value, char text[VALUE_TEXT_MAX])
{
	const int most = type == OWS_FLOAT ? FLT_DECIMAL_DIG : DBL_DECIMAL_DIG;
	int digits = type == OWS_FLOAT ? FLT_DIG : DBL_DIG;
	double number;
	int n;

	text[0] = '\0';
	if (!is_number(type))
		return 0;
	if (!value_is_float(type))
		return snprintf(text, VALUE_TEXT_MAX, "%lld", (long long)value);
	number = double_of(value);
	if (!isfinite(number))
		return snprintf(text, VALUE_TEXT_MAX, "%s",
		                isnan(number) ? "nan"
		                : number < 0  ? "-inf"
		                              : "inf");
	/* below the normal numbers fewer digits distinguish two numbers */
	if (fabs(number) < (type == OWS_FLOAT ? (double)FLT_MIN : DBL_MIN))
		digits = 1;
	do {
		n = print_digits(number, digits, text);
	} while (!reads_back(type, text, (size_t)n, number) && digits++ < most);
	return n;
}
