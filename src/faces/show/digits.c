/* SPDX-License-Identifier: MIT */
/* Numbers as persons read them: cut to the decimals that mean something. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "src/faces/show/digits.h"

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
