/* SPDX-License-Identifier: MIT */
/* Prints times as local time with its offset, and spans. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/base/time.h"
#include "src/faces/show/when.h"
#include "src/public/ows.h"

struct when when_now(void)
{
	return (struct when){.wall = clock_ns(CLOCK_REALTIME), .boot = ows_now()};
}

const char *when_iso(const struct when *now, int64_t boot_ns, char text[WHEN_TEXT])
{
	int64_t wall = now->wall - (now->boot - boot_ns);
	time_t seconds = (time_t)(wall / NS_PER_S);
	struct tm local;
	char day[24], zone[8];

	if (wall < 0 || !localtime_r(&seconds, &local) ||
	    !strftime(day, sizeof(day), "%Y-%m-%dT%H:%M:%S", &local) ||
	    strftime(zone, sizeof(zone), "%z", &local) != 5)
		snprintf(text, WHEN_TEXT, "?");
	else
		snprintf(text, WHEN_TEXT, "%s.%03d%.3s:%.2s", day,
		         (int)(wall % NS_PER_S / NS_PER_MS), zone, zone + 3);
	return text;
}

const char *when_span(int64_t ns, char text[WHEN_TEXT])
{
	int64_t s = ns / NS_PER_S;

	if (s < 0)
		snprintf(text, WHEN_TEXT, "0.0s");
	else if (s < 10)
		snprintf(text, WHEN_TEXT, "%d.%ds", (int)s, (int)(ns % NS_PER_S / (NS_PER_S / 10)));
	else if (s < 120)
		snprintf(text, WHEN_TEXT, "%ds", (int)s);
	else if (s < 120 * 60)
		snprintf(text, WHEN_TEXT, "%dm", (int)(s / 60));
	else if (s < 48 * 3600)
		snprintf(text, WHEN_TEXT, "%dh", (int)(s / 3600));
	else
		snprintf(text, WHEN_TEXT, "%lldd", (long long)(s / 86400));
	return text;
}

/* A span at the beginning of text; returns what stands behind it, NULL: there is none. */
static const char *take_span(const char *text, int64_t *ns)
{
	static const struct {
		const char *name;
		double seconds;
	} units[] = {{"seconds", 1}, {"minutes", 60}, {"hours", 3600}, {"days", 86400}};
	char *end;
	double number = strtod(text, &end);
	size_t len;

	if (end == text)
		return NULL;
	text = end + (*end == ' ' && strcmp(end, " ago") != 0);
	len = strcspn(text, " ");
	for (size_t i = 0; i < sizeof(units) / sizeof(units[0]); i++) {
		if (strncmp(text, units[i].name, len) != 0)
			continue;
		number *= units[i].seconds;
		if (!(number > 0) || number > 36600 * 86400.0)
			return NULL;
		*ns = (int64_t)(number * 1e9);
		return text + len;
	}
	return NULL;
}

bool when_parse(const char *text, int64_t *ns)
{
	int64_t span_ns;
	const char *rest = take_span(text, &span_ns);

	if (!rest || *rest)
		return false;
	*ns = span_ns;
	return true;
}

#define FIRST_YEAR 1970
#define LAST_YEAR 2114 /* libows-history draws none of later ones */
#define WANTED "expected a time such as 24h, \"5m ago\", yesterday, or 2026-11-26T14:30"

/* The fraction of a second at the beginning of text, as ns; text where none stands. */
static const char *take_fraction(const char *text, int64_t *ns)
{
	int64_t digit = NS_PER_S / 10;

	if (*text != '.' || text[1] < '0' || text[1] > '9')
		return text;
	for (text++; *text >= '0' && *text <= '9'; text++, digit /= 10)
		*ns += (*text - '0') * digit;
	return text;
}

/* Parse a time by ISO 8601. NULL, or what is wrong. */
static const char *take_date(const char *text, int64_t *wall_ns)
{
	struct tm tm = {.tm_isdst = -1}, day;
	const char *end = strptime(text, "%Y-%m-%d", &tm), *more;
	int64_t fraction_ns = 0;
	long east_s;
	bool zoned = false;

	if (end && (*end == 'T' || *end == ' ')) {
		end = strptime(end + 1, "%H:%M", &tm);
		more = end && *end == ':' ? strptime(end, ":%S", &tm) : NULL;
		end = more ? take_fraction(more, &fraction_ns) : end;
		if (end && (*end == 'Z' || *end == '+' || *end == '-')) {
			end = strptime(end, "%z", &tm);
			zoned = true;
		}
	}
	if (!end || *end)
		return WANTED;
	/* mktime() takes the 30th of February for a day of March */
	day = (struct tm){.tm_year = tm.tm_year, .tm_mon = tm.tm_mon, .tm_mday = tm.tm_mday};
	timegm(&day);
	if (day.tm_mday != tm.tm_mday)
		return "there is no such day";
	if (tm.tm_sec > 59)
		return "there is no such second";
	if (tm.tm_year + 1900 < FIRST_YEAR || tm.tm_year + 1900 > LAST_YEAR)
		return "only the years 1970 to 2114 can be asked for";
	east_s = tm.tm_gmtoff; /* timegm() sets it to 0 */
	*wall_ns = (int64_t)(zoned ? timegm(&tm) - east_s : mktime(&tm)) * NS_PER_S + fraction_ns;
	*wall_ns = *wall_ns > 0 ? *wall_ns : 0;
	return NULL;
}

/* So many midnights ago, local time. */
static int64_t midnight(const struct when *now, int days)
{
	time_t seconds = (time_t)(now->wall / NS_PER_S);
	struct tm local = {0};

	localtime_r(&seconds, &local);
	local = (struct tm){.tm_year = local.tm_year,
	                    .tm_mon = local.tm_mon,
	                    .tm_mday = local.tm_mday - days,
	                    .tm_isdst = -1};
	return (int64_t)mktime(&local) * NS_PER_S;
}

const char *when_moment(const struct when *now, const char *text, int64_t *wall_ns)
{
	int64_t span_ns;
	const char *rest = take_span(text, &span_ns);

	if (rest && (!*rest || !strcmp(rest, " ago")))
		*wall_ns = now->wall > span_ns ? now->wall - span_ns : 0;
	else if (!strcmp(text, "now"))
		*wall_ns = now->wall;
	else if (!strcmp(text, "today"))
		*wall_ns = midnight(now, 0);
	else if (!strcmp(text, "yesterday"))
		*wall_ns = midnight(now, 1);
	else
		return take_date(text, wall_ns);
	return NULL;
}
