/* SPDX-License-Identifier: MIT */
/* Scaling of raw values to engineering values and back, by a factor or through points. */
#include <errno.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "src/ground/signal/scale.h"
#include "src/ground/signal/value.h"
#include "src/public/ows.h"

bool scale_changes(const struct scale *scale)
{
	return scale->linear || scale->count;
}

bool scale_same(const struct scale *a, const struct scale *b)
{
	if (a->linear != b->linear || a->count != b->count || a->has_min != b->has_min ||
	    a->has_max != b->has_max)
		return false;
	if ((a->has_min && a->min != b->min) || (a->has_max && a->max != b->max))
		return false;
	if (a->linear && (a->factor != b->factor || a->offset != b->offset))
		return false;
	for (unsigned i = 0; i < a->count; i++)
		if (a->points[i].raw != b->points[i].raw ||
		    a->points[i].value != b->points[i].value)
			return false;
	return true;
}

/* --- The line through points ----------------------------------------------------------------- */

/* One piece of the line, in either direction: y goes from y0 to y1 while x goes from x0 to x1. */
struct piece {
	double x0, y0, x1, y1;
};

static struct piece piece_of(const struct scale *scale, unsigned i, bool inverse)
{
	const struct scale_point *a = &scale->points[i], *b = &scale->points[i + 1];

	if (inverse)
		return (struct piece){a->value, a->raw, b->value, b->raw};
	return (struct piece){a->raw, a->value, b->raw, b->value};
}

/* Does x lie on the far side of the piece's end? */
static bool is_after(const struct piece *p, double x)
{
	return p->x1 > p->x0 ? x > p->x1 : x < p->x1;
}

static bool is_inside(const struct piece *p, double x)
{
	return x >= fmin(p->x0, p->x1) && x <= fmax(p->x0, p->x1);
}

static double line(const struct scale *scale, double x, bool inverse)
{
	struct piece p = piece_of(scale, 0, inverse);
	double y;

	for (unsigned i = 1; i + 1 < scale->count && is_after(&p, x); i++)
		p = piece_of(scale, i, inverse);
	if (x == p.x0 || x == p.x1) /* the points themselves are exact */
		return x == p.x0 ? p.y0 : p.y1;
	y = p.y0 + (x - p.x0) / (p.x1 - p.x0) * (p.y1 - p.y0);
	/* rounding does not leave the piece: so the line rises, or falls, throughout */
	return is_inside(&p, x) ? fmin(fmax(y, fmin(p.y0, p.y1)), fmax(p.y0, p.y1)) : y;
}

/* The values between which the line is: those of its ends, unless the range continues them. */
static double line_least(const struct scale *scale)
{
	if (!scale->count || scale->has_min)
		return -HUGE_VAL;
	return fmin(scale->points[0].value, scale->points[scale->count - 1].value);
}

static double line_most(const struct scale *scale)
{
	if (!scale->count || scale->has_max)
		return HUGE_VAL;
	return fmax(scale->points[0].value, scale->points[scale->count - 1].value);
}

/* --- Values ---------------------------------------------------------------------------------- */

/*
 * A value that rounding has put beyond the range by some units of its last place is at the end of
 * the range: a transmitter at exactly 4 mA is not out of range.
 */
static double undo_rounding(const struct scale *scale, double raw, double value)
{
	double noise = 4 * DBL_EPSILON *
	               (scale->linear ? fabs(raw * scale->factor) + fabs(scale->offset)
	                              : fabs(value));

	if (!scale_changes(scale) || !isfinite(noise))
		return value;
	if (scale->has_min && value < scale->min && value >= scale->min - noise)
		return scale->min;
	if (scale->has_max && value > scale->max && value <= scale->max + noise)
		return scale->max;
	return value;
}

static bool is_beyond(const struct scale *scale, double value)
{
	return (scale->has_min && value < scale->min) || (scale->has_max && value > scale->max);
}

double scale_value(const struct scale *scale, double raw, uint8_t *quality)
{
	double value = raw, least = fmax(line_least(scale), -DBL_MAX),
	       most = fmin(line_most(scale), DBL_MAX);

	if (scale->linear)
		value = raw * scale->factor + scale->offset + 0.0; /* no negative zero */
	else if (scale->count)
		value = line(scale, raw, false) + 0.0;
	value = undo_rounding(scale, raw, value);
	*quality = value < least ? OWS_Q_LOW : value > most ? OWS_Q_HIGH : OWS_Q_GOOD;
	value = fmin(fmax(value, least), most);
	if (is_beyond(scale, value))
		*quality = OWS_Q_RANGE;
	return value;
}

int scale_raw(const struct scale *scale, double value, double *raw)
{
	double found = value;

	if (is_beyond(scale, value) || value < line_least(scale) || value > line_most(scale))
		return -ERANGE;
	if (scale->linear)
		found = (value - scale->offset) / scale->factor + 0.0;
	else if (scale->count)
		found = line(scale, value, true) + 0.0;
	if (!isfinite(found))
		return -ERANGE;
	*raw = found;
	return 0;
}

/* --- The text of points ---------------------------------------------------------------------- */

static bool parse_number(const char *text, size_t len, double *number)
{
	int64_t value;
	uint8_t quality;

	if (!len || value_from_text(OWS_DOUBLE, text, len, &value, &quality) ||
	    quality != OWS_Q_GOOD)
		return false;
	*number = value_number(OWS_DOUBLE, value);
	return true;
}

/* Differences have to be finite, so that no line is ever NaN. */
static int check_points(const struct scale_point *points, int count)
{
	bool rises = points[1].value > points[0].value;

	for (int i = 1; i < count; i++) {
		double step = points[i].value - points[i - 1].value;

		if (points[i].raw <= points[i - 1].raw ||
		    !isfinite(points[i].raw - points[i - 1].raw))
			return -EINVAL;
		if (!isfinite(step) || step == 0 || (step > 0) != rises)
			return -ERANGE;
	}
	return 0;
}

int scale_parse(const char *text, struct scale_point points[SCALE_POINTS_MAX])
{
	static const char blanks[] = " \t";
	int count = 0, err;

	for (text += strspn(text, blanks); *text; text += strspn(text, blanks)) {
		size_t len = strcspn(text, blanks);
		const char *colon = memchr(text, ':', len);
		struct scale_point point;

		if (!colon || !parse_number(text, (size_t)(colon - text), &point.raw) ||
		    !parse_number(colon + 1, (size_t)(text + len - colon - 1), &point.value))
			return -EILSEQ;
		if (count == SCALE_POINTS_MAX)
			return -E2BIG;
		points[count++] = point;
		text += len;
	}
	if (count < 2)
		return -EDOM;
	err = check_points(points, count);
	return err ? err : count;
}
