/* SPDX-License-Identifier: MIT */
/* Which alarms are told, how severe they are, and when they wait. */
#include <fnmatch.h>
#include <stdio.h>
#include <string.h>

#include "src/config/read/texts.h"
#include "src/faces/notify/rules.h"

bool rules_critical(const struct ows_alarm *alarm)
{
	return alarm->event != OWS_ALARM_FAILED &&
	       (alarm->kind == OWS_ALARM_HH || alarm->kind == OWS_ALARM_LL ||
	        alarm->kind == OWS_ALARM_DEVICE || alarm->kind == OWS_ALARM_POR);
}

bool rules_of_limit(uint8_t kind)
{
	return kind >= OWS_ALARM_HH && kind <= OWS_ALARM_BAD;
}

bool rules_urgent(const struct ows_alarm *alarm)
{
	return alarm->event == OWS_ALARM_RAISED && rules_critical(alarm);
}

bool rules_chosen(const char *patterns, const char *name)
{
	char pattern[256];
	/* a list that only takes out means all others */
	bool chosen = patterns[strspn(patterns, ", ")] == '!';

	for (const char *one = patterns + strspn(patterns, ", "); *one; one += strspn(one, ", ")) {
		int len = (int)strcspn(one, ", ");
		bool out = *one == '!';

		snprintf(pattern, sizeof(pattern), "%.*s", len - out, one + out);
		if (!fnmatch(pattern, name, 0))
			chosen = !out;
		one += len;
	}
	return chosen;
}

bool rules_quiet(const char *hours, unsigned minute)
{
	unsigned from, until;

	if (!hours || !text_hours(hours, &from, &until))
		return false;
	return from < until ? minute >= from && minute < until : minute >= from || minute < until;
}
