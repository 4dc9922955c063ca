/* SPDX-License-Identifier: MIT */
/* Scales of temperature and pressure that a client of the served protocol asks for. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/format.h"
#include "hal/owfs/frame.h"
#include "src/daemon/serve/units.h"

/* A scale as a straight line: client = bus * factor + offset. */
struct scale {
	double factor, offset;
};

/* C, F, K, R */
/* clang-format off */
static const struct scale temperatures[] = {
	{ 1, 0 }, { 1.8, 32 }, { 1, 273.15 }, { 1.8, 32 + 459.67 },
};
/* clang-format on */
/* mbar, atm, mmHg, inHg, psi, Pa. One mmHg is 133.322387415 Pa, a psi 6894.757293168 Pa. */
/* clang-format off */
static const double pressures[] = {
	1, 100 / 101325.0, 100 / 133.322387415, 100 / (25.4 * 133.322387415),
	100 / 6894.757293168, 100, 1, 1,
};
/* clang-format on */

static struct scale scale_of(char type, uint32_t flags)
{
	struct scale scale = {1, 0};

	if (type == 't' || type == 'g')
		scale = temperatures[FRAME_TEMPERATURE(flags)];
	else if (type == 'p')
		scale.factor = pressures[FRAME_PRESSURE(flags)];
	if (type == 'g') /* a difference of temperatures */
		scale.offset = 0;
	return scale;
}

static bool is_number_type(char type)
{
	return type && strchr("ifutgp", type);
}

bool units_asked(uint32_t flags)
{
	return FRAME_TEMPERATURE(flags) || pressures[FRAME_PRESSURE(flags)] != 1;
}

bool units_convert(char type, uint32_t flags)
{
	struct scale scale = scale_of(type, flags);

	return scale.factor != 1 || scale.offset != 0;
}

/* Parse one element, without the blanks of its padding. */
static int parse_element(const char *text, size_t len, double *number)
{
	char copy[TEXT_ROOM];

	return text_trimmed(text, len, copy) ? text_decimal(copy, number) : -EINVAL;
}

static size_t element_length(const char *text, size_t len)
{
	const char *comma = memchr(text, ',', len);

	return comma ? (size_t)(comma - text) : len;
}

/* Convert each element of `from` into `to`; the lengths may differ. */
static int convert_each(const struct scale *scale, bool back, const char *from, size_t len,
                        char *to, size_t room)
{
	size_t used = 0, at = 0;

	for (;;) {
		size_t n = element_length(from + at, len - at);
		double number;
		int put;

		if (parse_element(from + at, n, &number))
			return -EINVAL;
		number = back ? (number - scale->offset) / scale->factor
		              : number * scale->factor + scale->offset;
		put = snprintf(to + used, room - used, back ? "%.9G" : "%12G", number);
		if (put < 0 || (size_t)put + 1 >= room - used)
			return -EMSGSIZE;
		used += (size_t)put;
		at += n;
		if (at == len)
			return (int)used;
		to[used++] = ',';
		at++;
	}
}

static size_t drop_padding(char *text, size_t len)
{
	size_t used = 0;
	bool begins = true;

	for (size_t i = 0; i < len; i++) {
		if (begins && text[i] == ' ')
			continue;
		begins = text[i] == ',';
		text[used++] = text[i];
	}
	return used;
}

/* Is the value of a property with unknown type surely a padded number? */
static bool looks_padded(const char *text, size_t len)
{
	return len == 12 && text[0] == ' ' && text[len - 1] >= '0' && text[len - 1] <= '9' &&
	       strspn(text, " +-.0123456789E") >= len;
}

int units_show(char type, uint32_t flags, char *text, size_t len, size_t room)
{
	if (len && units_convert(type, flags)) {
		struct scale scale = scale_of(type, flags);
		/* two bytes ("1,") become 14 at most; what is not touched costs no memory */
		size_t most = 8 * len + 16 < room ? 8 * len + 16 : room;
		char *from = text + most - len;
		int n;

		/* from the end to the beginning, in place: the list of a logger is long */
		memmove(from, text, len);
		n = convert_each(&scale, false, from, len, text, most - len);
		if (n < 0)
			return n == -EINVAL ? -EIO : n;
		len = (size_t)n;
	}
	if (flags & FRAME_TRIM && (is_number_type(type) || (!type && looks_padded(text, len))))
		len = drop_padding(text, len);
	return (int)len;
}

int units_take(char type, uint32_t flags, const char *text, size_t len, char *out, size_t room)
{
	struct scale scale = scale_of(type, flags);

	if (len == 0)
		return -EINVAL;
	return convert_each(&scale, true, text, len, out, room);
}
