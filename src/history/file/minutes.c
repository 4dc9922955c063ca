/* SPDX-License-Identifier: MIT */
/* Sums as the file has them, and an hour of them as one text. */
#include "src/history/file/minutes.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/history/file/schema.h"
#include "src/public/ows.h"

#define SCALE 1e6
#define LARGEST 4.5e9 /* times SCALE it is below 2^53, and a thousandfold below 2^63 */
#define FINER 1000    /* of the mean */
#define NONE INT64_MIN

enum field { MINUTE, COUNT, LAST, LEAST, MOST, MEAN, GOOD, KNOWN, QUALITY, WORST, FIELDS };

struct minute minute_of(const struct rollup *sum, const struct rollup_state *state)
{
	bool has = sum->has_value;

	return (struct minute){
		.least = has ? sum->least : NAN,
		.most = has ? sum->most : NAN,
		.mean = rollup_mean(sum),
		.last = has ? sum->last : NAN,
		.good_us = sum->good_us,
		.known_us = sum->known_us,
		.count = sum->count,
		.quality = state->known ? state->quality : -1,
		.worst = sum->has_quality ? sum->worst : -1,
		.there = true,
	};
}

static int64_t within(int64_t us, int64_t most_us)
{
	return us < 0 ? 0 : us < most_us ? us : most_us;
}

void minute_take(const struct minute *minute, int64_t most_us, struct rollup *sum,
                 struct rollup_state *state)
{
	*sum = (struct rollup){
		.least = minute->least,
		.most = minute->most,
		.last = minute->last,
		.good_us = within(minute->good_us, most_us),
		.known_us = within(minute->known_us, most_us),
		.count = minute->count,
		.worst = (uint8_t)minute->worst,
		.has_value = !isnan(minute->least),
		.has_quality = minute->worst >= 0,
	};
	sum->sum_us = sum->has_value ? sum->good_us : 0;
	sum->sum = sum->has_value ? minute->mean * (double)sum->sum_us : 0;
	*state = (struct rollup_state){
		.value = sum->has_value ? sum->last : NAN,
		.quality = (uint8_t)minute->quality,
		.known = minute->quality >= 0,
	};
}

/* A value in millionths, if it is one of them. */
static bool in_millionths(double value, int64_t *n)
{
	if (!(fabs(value) < LARGEST))
		return false;
	*n = llround(value * SCALE);
	return (double)*n / SCALE == value;
}

static int64_t divisor(int64_t a, int64_t b)
{
	while (b) {
		int64_t rest = a % b;

		a = b;
		b = rest;
	}
	return a;
}

/* Of least, most and last of all minutes the lowest, and what they are apart from it. */
static bool find_scale(const struct minute minutes[MINUTES], int64_t *base, int64_t *step)
{
	bool any = false;

	*base = *step = 0;
	for (int i = 0; i < MINUTES; i++) {
		const double of[] = {minutes[i].least, minutes[i].most, minutes[i].last};

		for (int k = 0; k < 3 && minutes[i].there && !isnan(minutes[i].least); k++) {
			int64_t n;

			if (!in_millionths(of[k], &n))
				return false;
			if (!any)
				*base = n;
			any = true;
			*step = divisor(*step, llabs(n - *base));
			*base = n < *base ? n : *base;
		}
	}
	*step = *step ? *step : 1;
	return true;
}

static int print_minute(const struct minute *m, int at, int64_t base, int64_t step, char *text)
{
	int64_t n[FIELDS] = {at,   m->count,   NONE,        NONE,       NONE,
	                     NONE, m->good_us, m->known_us, m->quality, m->worst};
	const double of[] = {m->last, m->least, m->most};
	int64_t mostly[FIELDS] = {[GOOD] = MINUTE_US,
	                          [KNOWN] = MINUTE_US,
	                          [QUALITY] = OWS_Q_GOOD,
	                          [WORST] = OWS_Q_GOOD};
	int fields = FIELDS, used = 0;

	for (int k = 0; k < 3 && !isnan(m->least); k++)
		n[LAST + k] = (llround(of[k] * SCALE) - base) / step;
	if (!isnan(m->least))
		n[MEAN] = llround((m->mean * SCALE - (double)base) / (double)step * FINER);
	mostly[LEAST] = mostly[MOST] = n[LAST];
	mostly[MEAN] = n[LAST] == NONE ? NONE : n[LAST] * FINER;
	while (fields > LEAST && n[fields - 1] == mostly[fields - 1])
		fields--;
	for (int i = 0; i < fields; i++)
		used += n[i] == NONE ? sprintf(text + used, ",null")
		                     : sprintf(text + used, ",%lld", (long long)n[i]);
	text[0] = '[';
	text[used++] = ']';
	return used;
}

bool minutes_pack(const struct minute minutes[MINUTES], char text[MINUTES_TEXT])
{
	int64_t base, step;
	int used;

	if (!find_scale(minutes, &base, &step))
		return false;
	used = sprintf(text, "[%lld,%lld", (long long)base, (long long)step);
	for (int i = 0; i < MINUTES; i++) {
		if (!minutes[i].there)
			continue;
		text[used++] = ',';
		used += print_minute(&minutes[i], i, base, step, text + used);
	}
	text[used++] = ']';
	text[used] = '\0';
	return true;
}

/* The number, or null, after a sign; the text goes on after it. */
static bool take_number(const char **text, char sign, int64_t *n)
{
	const char *from = *text + 1;
	char *end;

	if (**text != sign)
		return false;
	*n = NONE;
	if (strncmp(from, "null", 4) == 0) {
		*text = from + 4;
		return true;
	}
	*n = strtoll(from, &end, 10);
	*text = end;
	return end != from;
}

static double value_of(int64_t n, double per, double base, double step)
{
	return n == NONE ? NAN : (base + step * (double)n / per) / SCALE;
}

/* Text stands at its bracket; it goes on after the other one. */
static int take_minute(const char **text, double base, double step, struct minute minutes[MINUTES])
{
	int64_t n[FIELDS] = {[GOOD] = MINUTE_US,
	                     [KNOWN] = MINUTE_US,
	                     [QUALITY] = OWS_Q_GOOD,
	                     [WORST] = OWS_Q_GOOD};
	int count = 0;

	while (count < FIELDS && take_number(text, count ? ',' : '[', &n[count]))
		count++;
	if (count <= LAST || **text != ']' || n[MINUTE] < 0 || n[MINUTE] >= MINUTES)
		return -EBADMSG;
	++*text;
	minutes[n[MINUTE]] = (struct minute){
		.last = value_of(n[LAST], 1, base, step),
		.least = value_of(n[count > LEAST ? LEAST : LAST], 1, base, step),
		.most = value_of(n[count > MOST ? MOST : LAST], 1, base, step),
		.mean = count > MEAN ? value_of(n[MEAN], FINER, base, step)
	                             : value_of(n[LAST], 1, base, step),
		.good_us = n[GOOD],
		.known_us = n[KNOWN],
		.count = (uint32_t)n[COUNT],
		.quality = n[QUALITY] < 0 ? -1 : (uint8_t)n[QUALITY],
		.worst = n[WORST] < 0 ? -1 : (uint8_t)n[WORST],
		.there = true,
	};
	return 0;
}

int minutes_unpack(const char *text, struct minute minutes[MINUTES])
{
	int64_t base, step;
	int err = 0;

	memset(minutes, 0, MINUTES * sizeof(*minutes));
	if (!take_number(&text, '[', &base) || !take_number(&text, ',', &step))
		return -EBADMSG;
	while (!err && *text == ',') {
		text++;
		err = take_minute(&text, (double)base, (double)step, minutes);
	}
	return err ? err : strcmp(text, "]") == 0 ? 0 : -EBADMSG;
}
