/* SPDX-License-Identifier: MIT */
/* owsctl list: a line for each signal. */
#include <getopt.h>

#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/rows.h"
#include "src/tool/owsctl/verbs.h"

static void list_print_table(struct ows *h, struct rows *rows, struct reading *reading)
{
	struct table table;

	table_init(&table, rows_columns, ROWS_COLUMNS);
	rows_absent(h, rows, &table);
	for (int i = 0; i < rows->count; i++) {
		row_read(h, &rows->row[i], ows_now(), reading);
		reading_round(reading, row_decimals(&rows->row[i]));
		rows_add_cells(&table, h, &rows->row[i], reading, false);
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
