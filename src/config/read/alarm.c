/* SPDX-License-Identifier: MIT */
/* What the alarm machine does for an item: its keys are read, and held against each other. */
#include <stdio.h>
#include <string.h>

#include "src/config/read/alarm.h"
#include "src/config/read/build.h"

static void warn_without_equals(struct build *build, const struct option_value *value,
                                const char *follows)
{
	if (value->given && *value->text && !strchr(value->text, '='))
		report_warning(
			build->report, value->node->value_at,
			"%s \"%s\" has no '=': nothing is written%s; expected property=value",
			value->node->key, value->text, follows);
}

const char *alarm_path(const struct config_item *item, const char *string, char path[ALARM_PATH])
{
	int len = string ? (int)strcspn(string, "=") : 0;
	struct path split;
	size_t head;

	if (!len || path_split(item->path, strlen(item->path), &split) || !split.property.len)
		return NULL;
	head = (size_t)(split.property.text - item->path);
	if (head + (size_t)len >= ALARM_PATH)
		return NULL;
	snprintf(path, ALARM_PATH, "%.*s%.*s", (int)head, item->path, len, string);
	return path + head;
}

/*
 * The strings of an alarm that is off. In a file whose IOType has bits that owsd does not know one
 * of them may be the alarm: then its alarms were lost without a word.
 */
static void check_off(struct build *build, const struct option_value *values)
{
	static const enum option strings[] = {OPT_LATCH_ALARM, OPT_POR_ALARM, OPT_SET_ALARM,
	                                      OPT_RESET_LATCH};
	const struct option_value *alarm = &values[OPT_ALARM], *first = NULL;
	const struct option_value *bits = &values[OPT_IO_TYPE];
	uint32_t unknown = bits->given ? (uint32_t)bits->number & ~IO_TYPE_KNOWN : 0;

	for (size_t i = 0; i < sizeof(strings) / sizeof(strings[0]) && !first; i++)
		first = *values[strings[i]].text ? &values[strings[i]] : NULL;
	if (!first)
		return;
	if (!alarm->node && unknown)
		report_error(build->report, first->node->at,
		             "%s is there and Alarm is not, and IOType %s has the unknown bits "
		             "0x%04X: write Alarm on, or Alarm off if it is to do nothing",
		             first->node->key, bits->text, (unsigned)unknown);
	else if (build_sound(build))
		report_warning(
			build->report, first->node->at,
			"%s does nothing %s: write Alarm on, or take the keys of the alarm out",
			first->node->key, alarm->node ? "while Alarm is off" : "without Alarm");
}

/* Table 3.1: rows 3 and 10 leave for the next alarm when these are not defined. */
void alarm_build(struct build *build, const struct rio_node *block,
                 const struct option_value *values, const struct path *path,
                 struct config_item *item)
{
	const struct option_value *alarm = &values[OPT_ALARM];
	struct rio_position position = alarm->node ? alarm->node->value_at : block->at;
	bool latch_empty;

	latch_empty = item->latch_alarm && !*item->latch_alarm;
	if (!item->alarm) {
		check_off(build, values);
		return;
	}
	if (*item->path && !path->device.len)
		report_error(build->report, position,
		             "Alarm on: expected a device in the path \"%s\"", item->path);
	if (!values[OPT_POR_ALARM].node)
		report_warning(
			build->report, position,
			"this alarm can never do anything: PorAlarm is not defined; write "
			"PorAlarm \"por\", or PorAlarm \"\" if the device has no such property");
	if (!values[OPT_LATCH_ALARM].node || latch_empty)
		report_warning(build->report, position,
		               "this alarm never reads anything: LatchAlarm is %s; write the "
		               "device's latch such as LatchAlarm \"latch.BYTE\", or LatchAlarm "
		               "\"present\" if it has none",
		               latch_empty ? "empty" : "not defined");
	if (item->por_alarm && *item->por_alarm && !item->set_alarm)
		report_warning(
			build->report, position,
			"this alarm cannot be armed after a restart of its device: SetAlarm is "
			"not defined, so %s is never cleared; write SetAlarm "
			"\"property=value\", or SetAlarm \"\" if nothing has to be set",
			item->por_alarm);
	warn_without_equals(
		build, &values[OPT_SET_ALARM],
		item->por_alarm && *item->por_alarm
			? ", and the alarm cannot be armed after a restart of its device"
			: "");
	warn_without_equals(build, &values[OPT_RESET_LATCH], "");
}
