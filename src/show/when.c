/* SPDX-License-Identifier: MIT */
/* Prints times as local time with its offset, and spans. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/bus/time.h"
#include "src/libows/ows.h"
#include "src/show/when.h"

struct when when_now(void)
{
	struct timespec wall;
	struct when now;

	clock_gettime(CLOCK_REALTIME, &wall);
	now.wall = (int64_t)wall.tv_sec * NS_PER_S + wall.tv_nsec;
	now.boot = ows_now();
	return now;
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

bool when_parse(const char *text, int64_t *ns)
{
	static const struct {
		const char *word;
		double seconds;
	} units[] = {{"", 1}, {"s", 1}, {"m", 60}, {"h", 3600}, {"d", 86400}};
	char *end;
	double number = strtod(text, &end);

	for (size_t i = 0; end != text && i < sizeof(units) / sizeof(units[0]); i++) {
		if (strcmp(end, units[i].word) != 0)
			continue;
		number *= units[i].seconds;
		if (!(number > 0) || number > 36600 * 86400.0)
			return false;
		*ns = (int64_t)(number * 1e9);
		return true;
	}
	return false;
}

bool when_moment(const struct when *now, const char *text, int64_t *wall_ns)
{
	static const char *const forms[] = {"%Y-%m-%d", "%Y-%m-%dT%H:%M", "%Y-%m-%dT%H:%M:%S",
	                                    "%Y-%m-%d %H:%M", "%Y-%m-%d %H:%M:%S"};
	int64_t span_ns;

	if (when_parse(text, &span_ns)) {
		*wall_ns = now->wall > span_ns ? now->wall - span_ns : 0;
		return true;
	}
	for (size_t i = 0; i < sizeof(forms) / sizeof(forms[0]); i++) {
		struct tm local = {.tm_isdst = -1};
		const char *end = strptime(text, forms[i], &local);
		int64_t seconds = end && !*end ? mktime(&local) : -1;

		if (seconds < 0 || seconds > INT64_MAX / NS_PER_S)
			continue;
		*wall_ns = seconds * NS_PER_S;
		return true;
	}
	return false;
}
