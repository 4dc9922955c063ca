/* SPDX-License-Identifier: MIT */
/* Numbers as persons read them: cut to the decimals that mean something. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "src/faces/show/digits.h"
#include "src/ground/signal/value.h"

#define SCRIPT_LEAST 6
#define SCRIPT_MOST 12
#define DECIMALS_MOST 99 /* printf() would compute as many as it is asked for */

void digits_print(enum ows_type type, double number, int64_t integer, int decimals,
                  char text[VALUE_TEXT_MAX])
{
	char cut[VALUE_TEXT_MAX];
	int n;

	value_to_text(type, value_is_float(type) ? value_of_double(number) : integer, text);
	if (decimals < 0 || decimals > DECIMALS_MOST || !value_is_float(type) || !isfinite(number))
		return;
	n = snprintf(cut, sizeof(cut), "%.*f", decimals, number);
	if (n >= (int)sizeof(cut)) /* so great that decimals do not matter */
		return;
	while (decimals > 0 && cut[n - 1] == '0')
		n--;
	if (cut[n - 1] == '.')
		n--;
	cut[n] = '\0';
	snprintf(text, VALUE_TEXT_MAX, "%s", strcmp(cut, "-0") == 0 ? "0" : cut);
}

int digits_of_script(double number, int decimals)
{
	double size = fabs(number);
	int wanted = SCRIPT_LEAST;

	if (size > 0 && size < 1)
		wanted = (int)fmin(SCRIPT_LEAST - 1 - floor(log10(size)), SCRIPT_MOST);
	return decimals < 0 || decimals > wanted ? decimals : wanted;
}

/* --- The values that a signal can have ------------------------------------------------------- */

static const struct {
	const char *least, *most;
} ranges[] = {
	[OWS_BOOL] = {"0", "1"},
	[OWS_BYTE] = {"0", "255"},
	[OWS_SHORT] = {"-32768", "32767"},
	[OWS_LONG] = {"-2147483648", "2147483647"},
	[OWS_WORD] = {"0", "65535"},
	[OWS_DWORD] = {"0", "4294967295"},
	[OWS_FLOAT] = {NULL, "3.4e38"},
	[OWS_DOUBLE] = {NULL, "1.8e308"},
	[OWS_LARGE] = {"-9223372036854775808", "9223372036854775807"},
};

/* Does the type hold it? */
static bool is_within(enum ows_type type, double limit)
{
	int64_t value;

	return value_is_float(type) ? isfinite(limit) : value_set_double(type, limit, &value) == 0;
}

const char *range_words(enum ows_type type, double min, double max, char words[RANGE_WORDS])
{
	char own_least[VALUE_TEXT_MAX], own_most[VALUE_TEXT_MAX];
	bool has_min = is_within(type, min), has_max = is_within(type, max);
	const char *least, *most;

	if (!value_type_ok(type) || type == OWS_STRING) {
		snprintf(words, RANGE_WORDS, "a text of up to %d bytes", VALUE_STRING_MAX);
		return words;
	}
	least = ranges[type].least;
	most = ranges[type].most;
	if (has_min) {
		value_to_text(OWS_DOUBLE, value_of_double(min), own_least);
		least = own_least;
	}
	if (has_max) {
		value_to_text(OWS_DOUBLE, value_of_double(max), own_most);
		most = own_most;
	}
	if (type == OWS_BOOL)
		snprintf(words, RANGE_WORDS, "0 or 1");
	else if (!least)
		snprintf(words, RANGE_WORDS, "up to %s", most);
	else if (value_is_float(type) && !has_max)
		snprintf(words, RANGE_WORDS, "%s or more", least);
	else
		snprintf(words, RANGE_WORDS, "%s to %s", least, most);
	return words;
}
