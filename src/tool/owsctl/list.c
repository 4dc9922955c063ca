/* SPDX-License-Identifier: MIT */
/* owsctl list: a line for each signal. */
#include <getopt.h>

#include "src/ground/signal/value.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/rows.h"
#include "src/tool/owsctl/table.h"
#include "src/tool/owsctl/verbs.h"

/* clang-format off */
static const struct table_column columns[] = {
	{"NAME"}, {"VALUE", .right = true, .most = 40}, {"UNIT"}, {"QUALITY"}, {"ALARM"},
	{"AGE", .right = true}, {"TYPE"}, {"IO"}, {"TARGET"}, {"PATH"},
};
/* clang-format on */
enum { UNIT = 2, ALARM = 4 };

static void list_add_row(struct table *table, struct ows *h, const struct row *row,
                         const struct reading *reading)
{
	char value[128], words[READING_WORDS], alarm[STANDING_WORDS], span[WHEN_TEXT] = "-";
	struct ows_target target = {.name = "-"};

	row_show(row, reading, value, sizeof(value));
	if (reading->value.measured_ns)
		when_span(reading->value.age_ns, span);
	if (row->path)
		ows_target(h, reading->value.target, &target);
	table_add(table, (const char *const[]){row->name, value, row_unit(row),
	                                       row_quality(row, reading, words),
	                                       standing_text(&row->alarms, alarm), span,
	                                       value_type_name((enum ows_type)reading->value.type),
	                                       !row->path    ? ""
	                                       : row->output ? "out"
	                                                     : "in",
	                                       target.name, row->path ? row->path : ""});
}

static void list_print_table(struct ows *h, struct rows *rows, struct reading *reading)
{
	struct table table;

	table_init(&table, columns, sizeof(columns) / sizeof(columns[0]));
	table.absent[UNIT] = !rows_have_units(rows);
	table.absent[ALARM] = !rows_have_alarms(h, rows);
	for (int i = 0; i < rows->count; i++) {
		row_read(h, &rows->row[i], ows_now(), reading);
		reading_round(reading, row_decimals(&rows->row[i]));
		list_add_row(&table, h, &rows->row[i], reading);
	}
	table_print(&table, true);
	table_free(&table);
}

static void list_print_json(struct ows *h, struct rows *rows, struct reading *reading)
{
	struct when now = when_now();
	struct json json;

	json_list(&json, stdout, true);
	for (int i = 0; i < rows->count; i++) {
		row_read(h, &rows->row[i], now.boot, reading);
		json_object(&json, NULL);
		row_json(&json, h, &rows->row[i], now.boot);
		reading_json(&json, h, reading, &now);
		json_object_end(&json);
	}
	json_list_end(&json);
}

int verb_list(struct ctl *ctl, int argc, char **argv)
{
	static struct reading reading;
	int status, patterns;
	struct rows rows;
	struct ows *h;
	bool driver = false;

	while (ctl_option(ctl, argc, argv, "a") != -1)
		driver = true;
	patterns = argc - optind;
	h = ctl_open(ctl, OWS_READ);
	rows_collect(h, argv + optind, patterns, driver, &rows);
	if (ctl_alive(ctl, h, ows_now()))
		ctl_refused(ctl, h, ows_now());
	if (ctl->json)
		list_print_json(h, &rows, &reading);
	else
		list_print_table(h, &rows, &reading);
	status = rows_check(&rows, argv + optind, patterns);
	rows_free(&rows);
	ows_close(h);
	return status;
}
