/* SPDX-License-Identifier: MIT */
/* owsctl alarms history: the journal. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>

#include "src/owsctl/alarms_history.h"
#include "src/owsctl/alarms_live.h"
#include "src/owsctl/table.h"
#include "src/show/digits.h"
#include "src/show/json.h"
#include "src/show/names.h"
#include "src/show/when.h"
#include "src/show/who.h"

/* clang-format off */
static const struct table_column columns[] = {
	{"TIME"}, {"NAME"}, {"ALARM"}, {"EVENT"}, {"BEFORE", .right = true}, {"AFTER", .right = true},
	{"QUALITY"}, {"BY"}, {"REMARK"},
};
/* clang-format on */

static const char *value_text(const struct ows_alarm *alarm, bool after, int decimals,
                              char text[VALUE_TEXT_MAX])
{
	enum ows_type type = (enum ows_type)alarm->type;
	double number = after ? alarm->after : alarm->before;
	int64_t integer = after ? alarm->after_integer : alarm->before_integer;

	if (!(after ? alarm->has_after : alarm->has_before) || type == OWS_STRING)
		return NULL;
	digits_print(type, number, integer, decimals, text);
	return text;
}

static bool alarms_history_add_row(struct table *table, const struct when *now,
                                   const struct ows_info *info, const struct ows_alarm *alarm)
{
	char before[VALUE_TEXT_MAX], after[VALUE_TEXT_MAX], time[WHEN_TEXT];
	const char *left = value_text(alarm, false, info->decimals, before);
	const char *right = value_text(alarm, true, info->decimals, after);
	char by[WHO_LINE] = "-";

	if (alarm->event != OWS_ALARM_RAISED && alarm->event != OWS_ALARM_RETURNED &&
	    alarm->event != OWS_ALARM_FAILED)
		who_line(&alarm->who, by);
	return table_add(table,
	                 (const char *const[]){when_iso(now, alarm->occurred_ns, time), info->name,
	                                       ows_alarm_kind_text(alarm->kind),
	                                       ows_alarm_event_text(alarm->event),
	                                       left ? left : "-", right ? right : "-",
	                                       ows_quality_text(alarm->quality), by, alarm->text});
}

static void json_value(struct json *json, const char *key, const char *text)
{
	if (text)
		json_number(json, key, text);
	else
		json_null(json, key);
}

static void add_json(struct json *json, const struct when *now, uint32_t number, const char *name,
                     const struct ows_alarm *alarm)
{
	char text[VALUE_TEXT_MAX], time[WHEN_TEXT];

	json_object(json, NULL);
	json_uint(json, "number", number);
	json_string(json, "time", when_iso(now, alarm->occurred_ns, time));
	json_string(json, "name", name);
	json_string(json, "alarm", ows_alarm_kind_text(alarm->kind));
	json_string(json, "event", ows_alarm_event_text(alarm->event));
	json_value(json, "before", value_text(alarm, false, -1, text));
	json_value(json, "after", value_text(alarm, true, -1, text));
	json_string(json, "quality", ows_quality_text(alarm->quality));
	who_json(json, &alarm->who);
	json_string(json, "remark", *alarm->text ? alarm->text : NULL);
	json_object_end(json);
}

/* Put all entries of the journal, the oldest first, into the table or the document. */
static bool walk(struct ows *h, char *const *patterns, int count, struct table *table,
                 struct json *json)
{
	uint32_t head = ows_alarm_count(h), first = head;
	struct when now = when_now();
	struct ows_alarm alarm;
	struct ows_info info;
	bool ok = true;

	while (ows_alarm(h, first - 1, &alarm) != -ENOENT)
		first--;
	for (uint32_t number = first; ok && number != head; number++) {
		if (ows_alarm(h, number, &alarm) != 0 || ows_info(h, alarm.signal, &info) != 0 ||
		    !names_match(info.name, patterns, count))
			continue;
		if (table)
			ok = alarms_history_add_row(table, &now, &info, &alarm);
		else
			add_json(json, &now, number, info.name, &alarm);
	}
	return ok;
}

static bool print_table(struct ows *h, char *const *patterns, int count)
{
	struct table table;
	bool ok;

	table_init(&table, columns, sizeof(columns) / sizeof(columns[0]));
	ok = walk(h, patterns, count, &table, NULL);
	if (ok)
		table_print(&table, true);
	table_free(&table);
	return ok;
}

static void alarms_history_print_json(struct ows *h, char *const *patterns, int count)
{
	struct json json;

	json_open(&json, stdout);
	json_array(&json, NULL);
	walk(h, patterns, count, NULL, &json);
	json_array_end(&json);
	json_end(&json);
}

int alarms_history(struct ctl *ctl, int argc, char **argv)
{
	struct ows *h;
	int status;

	ctl_options();
	if (ctl_option(ctl, argc, argv, "") != -1)
		return CTL_USAGE;
	status = ctl_open(ctl, OWS_READ, &h);
	if (status)
		return status;
	ctl_alive(ctl, h, ows_now());
	if (!alarms_known(h, argv + optind, argc - optind))
		status = CTL_FAILED;
	else if (ctl->json)
		alarms_history_print_json(h, argv + optind, argc - optind);
	else if (!print_table(h, argv + optind, argc - optind))
		status = ctl_fail("no memory");
	ows_close(h);
	return status;
}
