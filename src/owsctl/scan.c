/* SPDX-License-Identifier: MIT */
#include "scan.h"
#include "table.h"

#include "../../hal/native/family.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

static const struct table_column columns[] = {
	{"PATH"}, {"FAMILY"}, {"TYPE"}, {"ALIAS"}, {"BUS"}, {"ALARM"}, {"VALUES"},
};

/* Does it answer an alarm search? NULL: not a family of ours. */
static const char *alarms(const struct scan_device *device)
{
	const struct family *family = family_of(device->family);

	if (family->code != device->family)
		return NULL;
	return family->alarms ? "yes" : "no";
}

/* "temperature12=21.5 ..." */
static void show_values(const struct scan_device *device, char *out, size_t size)
{
	size_t used = 0;

	out[0] = '\0';
	for (unsigned i = 0; device->kind && i < SCAN_PROPERTIES; i++) {
		const char *name = device->kind->property[i].name;
		const struct scan_value *value = &device->value[i];
		int n;

		if (!name || used >= size)
			break;
		n = snprintf(out + used, size - used, "%s%s=%s%s%s", used ? " " : "", name,
		             value->err ? "(" : "", value->err ? error_text(value->err) : value->text,
		             value->err ? ")" : "");
		used += n > 0 ? (size_t)n : 0;
	}
}

static bool print_table(const struct scan *scan)
{
	struct table table;
	char line[2048], family[4], bus[40], values[400];
	bool ok = true;

	table_init(&table, columns, sizeof(columns) / sizeof(columns[0]));
	for (unsigned i = 0; ok && i < scan->count; i++) {
		const struct scan_device *device = &scan->device[i];
		const char *alarm = alarms(device);

		snprintf(family, sizeof(family), "%02X", device->family);
		snprintf(bus, sizeof(bus), "%s%s", device->location[0] ? device->location : "-",
		         device->simulated ? " (simulated)" : "");
		show_values(device, values, sizeof(values));
		ok = table_add(&table, (const char *const[]){
			                       device->path, family, device->type,
			                       device->alias[0] ? device->alias : "-", bus,
			                       alarm ? alarm : "-", values});
	}
	table_fit(&table, 0);
	for (int i = -1; ok && i < (int)scan->count; i++) {
		table_line(&table, i, line, sizeof(line));
		puts(line);
	}
	table_free(&table);
	return ok;
}

static void print_values(struct json *json, const struct scan_device *device)
{
	json_object(json, "values");
	for (unsigned i = 0; device->kind && i < SCAN_PROPERTIES; i++) {
		const char *name = device->kind->property[i].name;
		const struct scan_value *value = &device->value[i];

		if (!name)
			break;
		if (value->err)
			json_null(json, name);
		else if (target_is_number(value->text, strlen(value->text)))
			json_number(json, name, value->text);
		else
			json_string(json, name, value->text);
	}
	json_object_end(json);
}

static void print_json(const struct scan *scan)
{
	struct json json;

	json_open(&json, stdout);
	json_array(&json, NULL);
	for (unsigned i = 0; i < scan->count; i++) {
		const struct scan_device *device = &scan->device[i];
		const char *alarm = alarms(device);
		char family[4];

		snprintf(family, sizeof(family), "%02X", device->family);
		json_object(&json, NULL);
		json_string(&json, "path", device->path);
		json_string(&json, "family", family);
		json_string(&json, "type", device->type);
		json_string(&json, "alias", device->alias[0] ? device->alias : NULL);
		json_string(&json, "bus", device->location[0] ? device->location : NULL);
		if (alarm)
			json_bool(&json, "alarm", *alarm == 'y');
		else
			json_null(&json, "alarm");
		json_bool(&json, "simulated", device->simulated);
		print_values(&json, device);
		json_object_end(&json);
	}
	json_array_end(&json);
	json_end(&json);
}

int verb_scan(struct ctl *ctl, int argc, char **argv)
{
	int64_t timeout_ns = OPEN_TIMEOUT_NS;
	bool rio = false, inputs_only = false;
	struct target target;
	struct scan scan;
	int c, status;

	ctl_options();
	while ((c = target_option(ctl, argc, argv, "ri", &timeout_ns)) != -1) {
		if (c == 'r')
			rio = true;
		else if (c == 'i')
			inputs_only = true;
		else
			return CTL_USAGE;
	}
	if (optind < argc)
		return ctl_usage(ctl, "%s: scan looks at all of a target", argv[optind]);
	if (rio ? ctl->json : inputs_only)
		return ctl_usage(ctl, rio ? "--rio is no JSON" : "-i goes with --rio");
	status = target_open(ctl, timeout_ns, &target);
	if (status) {
		scan_board(target.name);
		return status;
	}
	status = scan_target(&target, &scan);
	if (!status && !scan.count)
		scan_board(target.name);
	if (!status && rio && target.served.target[0] && target.served.cut)
		status = ctl_fail("the targets of owsd %s are too long to be told whole: name them with "
		                  "-t TARGET", ctl->instance);
	else if (!status && rio)
		status = target.served.target[0]
		                 ? scan_rio(&scan, target.served.targets, true, inputs_only)
		                 : scan_rio(&scan, target.name, false, inputs_only);
	else if (!status && ctl->json)
		print_json(&scan);
	else if (!status && !print_table(&scan))
		status = ctl_fail("no memory");
	target_close(&target);
	scan_free(&scan);
	return status;
}
