/* SPDX-License-Identifier: MIT */
/* owsctl scan: prints the devices of a target as a table, as JSON or as a configuration. */
#include <errno.h>
#include <getopt.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/bus/backends.h"
#include "hal/chips/family.h"
#include "hal/chips/find.h"
#include "hal/owfs/path.h"
#include "src/config/edit/edit.h"
#include "src/config/edit/rio_write.h"
#include "src/faces/show/json.h"
#include "src/faces/show/text.h"
#include "src/ground/board/board.h"
#include "src/ground/board/look.h"
#include "src/ground/board/report.h"
#include "src/ground/signal/value.h"
#include "src/ground/text/shell.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/open.h"
#include "src/tool/owsctl/scan/scan_item.h"
#include "src/tool/owsctl/scan/scan_merge.h"
#include "src/tool/owsctl/table.h"
#include "src/tool/owsctl/verbs.h"
#include "src/tool/scan/device.h"
#include "src/tool/scan/parallel.h"
#include "src/tool/scan/scan.h"

/* --- Names of an alias file of OWFS: "28.551DDF030000 = kitchen" in each line ---------------- */

/* Name each device of this id; a device behind several ways is found several times. */
static bool name_devices(struct scan *scan, const uint8_t rom[ROM_LEN], const char *name,
                         size_t len)
{
	char id[ROM_TEXT_MAX];
	bool found = false;

	rom_print(rom, ROM_F_I, id);
	for (unsigned i = 0; i < scan->count; i++) {
		struct scan_device *device = &scan->device[i];

		if (strcmp(strrchr(device->path, '/') + 1, id) != 0)
			continue;
		text_clean(name, len, sizeof(device->alias), device->alias, sizeof(device->alias));
		found = true;
	}
	return found;
}

/* One line as owserver takes it: an id with or without a slash, blanks or '=', and the name. */
static void scan_alias_take(const char *file, unsigned number, char *line, struct scan *scan)
{
	uint8_t rom[ROM_LEN];
	char *id = line + strspn(line, " \t/"), *name;
	size_t len = strcspn(id, " \t=:\r\n"), end;

	if (!len || *id == '#')
		return;
	name = id + len + strspn(id + len, " \t=:");
	for (end = strlen(name); end && strchr(" \t\r\n", name[end - 1]);)
		end--;
	if (rom_parse(id, len, rom))
		ctl_fail("%s:%u: %.*s is no id of a device", file, number, (int)len, id);
	else if (!end)
		ctl_fail("%s:%u: %.*s has no name here", file, number, (int)len, id);
	else if (!name_devices(scan, rom, name, end))
		ctl_fail("%s:%u: %.*s was not found", file, number, (int)len, id);
}

/*
 * Give the devices that were found the names that the file has for their ids; these go before an
 * alias that the target has. Prints the lines that name no device that was found. CTL_DONE, or
 * CTL_FAILED after printing why the file cannot be read.
 */
static int scan_aliases(const char *file, struct scan *scan)
{
	FILE *stream = fopen(file, "re");
	char *line = NULL;
	size_t room = 0;
	int err;

	if (!stream)
		return ctl_fail("%s: %s", file, strerror(errno));
	for (unsigned number = 1; getline(&line, &room, stream) >= 0; number++)
		scan_alias_take(file, number, line, scan);
	err = ferror(stream) ? errno : 0;
	free(line);
	fclose(stream);
	return err ? ctl_fail("%s: %s", file, strerror(err)) : CTL_DONE;
}

static int scan_rio_fill(struct rio **rio, struct scan_names *names, const struct scan *scan,
                         const char *target, struct scan_choice choice)
{
	int err = rio_set_text(rio, rio_child(&(*rio)->root, "OwsDrv"), "TargetName", target);

	for (unsigned i = 0; i < scan->count; i++)
		scan_make_items(names, &scan->device[i], choice);
	if (!err)
		err = scan_add_items(rio, names);
	return err;
}

/*
 * Print a configuration with that TargetName, which may be several targets. CTL_DONE, or CTL_FAILED
 * after printing why; then stdout got nothing.
 */
static int scan_rio(const struct scan *scan, const char *target, bool several,
                    struct scan_choice choice)
{
	struct config_report silent = {0};
	struct scan_names names;
	struct rio *rio = NULL;
	int err, status = CTL_DONE;

	/* several targets are written as in TargetName, so the name of a single one has neither */
	if (!several && strpbrk(target, ",|"))
		return ctl_fail("%s cannot be a TargetName: it holds \",\" or \"|\"", target);
	scan_names_init(&names, scan_items_most(scan));
	err = rio_parse("scan", edit_empty, strlen(edit_empty), &silent, &rio);
	if (!err)
		err = scan_rio_fill(&rio, &names, scan, target, choice);
	if (err)
		status = ctl_fail("%s", err == -ENOMEM ? "no memory" : strerror(-err));
	else if (!names.count)
		status = ctl_say(CTL_NOTHING,
		                 "%s has %u device%s, and none that a configuration could be made "
		                 "for",
		                 target, scan->count, scan->count == 1 ? "" : "s");
	else if ((status = scan_check(rio, target)) == CTL_DONE)
		fwrite(rio->text, 1, rio->len, stdout);
	if (rio)
		rio_free(rio);
	scan_names_free(&names);
	return status;
}

/*
 * After a scan that found nothing: print on stderr which board this is and what is missing there.
 * For a target that needs no I2C adapter, prints nothing.
 */
static void scan_board(const char *target)
{
	struct board_report report;
	char folder[400], why[800];
	const struct bus_ops *ops = target ? bus_backend(target, NULL) : NULL;

	if (!ops || !(ops->board_advice || !strcmp(target, "auto")))
		return;
	board_folder(folder, sizeof(folder));
	if (board_look("", folder, NULL, &report, why, sizeof(why)) == 0)
		board_print(&report, stderr);
}

static const struct table_column columns[] = {
	{"PATH"}, {"FAMILY"}, {"TYPE"}, {"ALIAS"}, {"BUS"}, {"ALARM"}, {"VALUES"},
};

/* Do devices of the family answer an alarm search? NULL: owsd does not know the family. */
static const char *alarms(const struct scan_device *device)
{
	const struct family *family = family_of(device->family);

	if (family->code != device->family)
		return NULL;
	return family->alarms ? "yes" : "no";
}

/* Write the values as "temperature12=21.5 ...", or the command that shows what there is. */
static void show_values(const struct scan_device *device, char *out, size_t size)
{
	struct scan_property property;
	char words[ERROR_WORDS], word[SHELL_WORD];
	size_t used = 0;

	out[0] = '\0';
	for (unsigned i = 0; used < size && scan_property(device, i, &property); i++) {
		const struct scan_value *value = &device->value[i];
		int n;

		/* of another chip with the same family code */
		if (value->err == -ENOENT)
			continue;
		n = snprintf(out + used, size - used, "%s%s=%s%s%s", used ? " " : "", property.name,
		             value->err ? "(" : "",
		             value->err ? error_answer_text(value->err, value->refused, words)
		                        : value->text,
		             value->err ? ")" : "");
		used += n > 0 ? (size_t)n : 0;
	}
	if (!used)
		snprintf(out, size, "(owsctl dir %s)", shell_word(device->path, word));
}

static void scan_print_table(const struct scan *scan)
{
	struct table table;
	char family[4], bus[40], values[400];

	table_init(&table, columns, sizeof(columns) / sizeof(columns[0]));
	for (unsigned i = 0; i < scan->count; i++) {
		const struct scan_device *device = &scan->device[i];
		const char *alarm = alarms(device);

		snprintf(family, sizeof(family), "%02X", device->family);
		snprintf(bus, sizeof(bus), "%s%s", device->location[0] ? device->location : "-",
		         device->simulated ? " (simulated)" : "");
		show_values(device, values, sizeof(values));
		const char *type = device->identity[0] ? device->identity : device->type;

		table_add(&table, (const char *const[]){device->path, family, type,
		                                        device->alias[0] ? device->alias : "-", bus,
		                                        alarm ? alarm : "-", values});
	}
	table_print(&table, true);
	table_free(&table);
}

static void print_values(struct json *json, const struct scan_device *device)
{
	struct scan_property property;

	json_object(json, "values");
	for (unsigned i = 0; scan_property(device, i, &property); i++) {
		const struct scan_value *value = &device->value[i];
		const char *name = property.name;

		if (value->err)
			json_null(json, name);
		else if (json_is_number(value->text, strlen(value->text)))
			json_number(json, name, value->text);
		else
			json_string(json, name, value->text);
	}
	json_object_end(json);
}

/* All that is known of the properties that most people want, to choose from. */
static void print_properties(struct json *json, const struct scan_device *device)
{
	struct scan_property property;
	char words[ERROR_WORDS];

	json_array(json, "properties");
	for (unsigned i = 0; scan_property(device, i, &property); i++) {
		const struct scan_value *value = &device->value[i];

		/* of another chip with the same family code */
		if (value->err == -ENOENT)
			continue;
		json_object(json, NULL);
		json_string(json, "name", property.name);
		json_string(json, "word", property.word);
		json_string(json, "type", value_type_name(property.type));
		json_bool(json, "output", property.output);
		json_string(json, "value", value->err ? NULL : value->text);
		json_string(json, "why",
		            value->err ? error_answer_words(value->err, value->refused, words)
		                       : NULL);
		json_object_end(json);
	}
	json_array_end(json);
}

/* The id, and the signals of owsd that are of it; another way to it is the same device. */
static void print_signals(struct json *json, struct ows *h, const struct scan_device *device)
{
	char id[ROM_TEXT_MAX];
	struct ows_info info;
	struct path own, path;

	if (path_split(device->path, strlen(device->path), &own) || !own.has_rom)
		return;
	rom_print(own.rom, ROM_F_I, id);
	json_string(json, "id", id);
	json_array(json, "signals");
	for (int i = 0; h && ows_info(h, i, &info) == 0; i++)
		if (!path_split(info.path, strlen(info.path), &path) && path.has_rom &&
		    !memcmp(path.rom, own.rom, ROM_LEN))
			json_string(json, NULL, info.name);
	json_array_end(json);
}

static void scan_print_json(const struct scan *scan, struct ows *h)
{
	struct json json;

	json_list(&json, stdout, true);
	for (unsigned i = 0; i < scan->count; i++) {
		const struct scan_device *device = &scan->device[i];
		const char *alarm = alarms(device);
		char family[4];

		snprintf(family, sizeof(family), "%02X", device->family);
		json_object(&json, NULL);
		json_string(&json, "path", device->path);
		json_string(&json, "family", family);
		json_string(&json, "type", device->type);
		json_string(&json, "identity", device->identity[0] ? device->identity : NULL);
		json_string(&json, "alias", device->alias[0] ? device->alias : NULL);
		json_string(&json, "bus", device->location[0] ? device->location : NULL);
		if (alarm)
			json_bool(&json, "alarm", *alarm == 'y');
		else
			json_null(&json, "alarm");
		json_bool(&json, "simulated", device->simulated);
		print_signals(&json, h, device);
		print_values(&json, device);
		print_properties(&json, device);
		json_object_end(&json);
	}
	json_list_end(&json);
}

/* Print the configuration: a new one, or the given file with the devices added. */
static int print_rio(const struct ctl *ctl, const struct target *target,
                     const struct served *served, const struct scan *scan, struct scan_merge *merge,
                     struct scan_choice choice)
{
	choice.target = served->target[0] ? NULL : target->name;
	choice.noted = !merge->file;
	if (merge->file)
		return scan_merge(merge, scan, choice);
	if (served->target[0] && served->cut)
		return ctl_fail(
			"the targets of owsd %s are too many to name them all: name them with "
			"-t TARGET",
			ctl->instance);
	return served->target[0] ? scan_rio(scan, served->targets, true, choice)
	                         : scan_rio(scan, target->name, false, choice);
}

/* After a failure, warn that the file to which stdout goes is empty. */
static void warn_of_empty_file(void)
{
	struct stat out;

	if (!fstat(STDOUT_FILENO, &out) && S_ISREG(out.st_mode) && !out.st_size)
		ctl_fail("no configuration was made: the file that the output goes to is empty");
}

/* The devices that are named, without a listing. */
static int take_named(char *const *names, unsigned count, struct scan *scan)
{
	char path[128];

	*scan = (struct scan){.device = calloc(count, sizeof(*scan->device))};
	if (!scan->device)
		return -ENOMEM;
	for (unsigned i = 0; i < count; i++) {
		snprintf(path, sizeof(path), "%s%s", *names[i] == '/' ? "" : "/", names[i]);
		if (!scan_device_of(path, &scan->device[scan->count++]))
			return ctl_fail("%s is no id of a device, such as 28.551DDF030000",
			                ctl_word(names[i]));
	}
	return 0;
}

/* An owsd serves several connections at the same time. */
static int find_devices(struct target *target, bool of_owsd, struct scan *scan, char *const *names,
                        unsigned count)
{
	int err = count ? take_named(names, count, scan) : scan_find(target, scan);

	if (err > 0)
		return err;
	if (err == -E2BIG)
		return ctl_fail("%s: more than 512 couplers", target->name);
	if (err == -EIO && of_owsd)
		return ctl_fail("%s: no target of this owsd lists devices: owsctl stats shows how "
		                "they do",
		                target->name);
	if (err && err != -ENOMEM)
		return ctl_fail("%s: %s", target->name, target_error(target, err));
	if (scan->disturbed)
		ctl_fail("%s: each search was disturbed (%s): what it knew before is listed, "
		         "and devices may be missing",
		         target->name, error_text(-EBADMSG));
	if (!err)
		err = of_owsd ? scan_read_parallel(target, scan, count > 0)
		              : scan_read(target, scan->device, scan->count, count > 0);
	if (err == -ENOMEM)
		return ctl_fail("no memory");
	return err ? ctl_fail("%s does not answer any more", target->name) : CTL_DONE;
}

/* What is asked of a scan. */
struct scan_order {
	int64_t timeout_ns;
	const char *aliases;
	bool rio;
	char *const *names; /* of devices; none: all */
	unsigned name_count;
};

static int scan_look(struct ctl *ctl, const struct scan_order *order, struct scan_choice choice,
                     struct scan_merge *merge)
{
	struct target target;
	struct served served;
	struct scan scan;
	struct ows *h = NULL;
	int status = open_target(ctl, order->timeout_ns, &target, &served);

	if (status) {
		scan_board(target.name);
		return status;
	}
	status = find_devices(&target, served.target[0], &scan, order->names, order->name_count);
	if (!status && order->aliases)
		status = scan_aliases(order->aliases, &scan);
	if (!order->rio && ctl->json && (!status || scan.count)) {
		if (served.target[0])
			h = ctl_open(ctl, OWS_READ);
		scan_print_json(&scan, h);
		ows_close(h);
	}
	if (!status && order->rio && scan.count)
		status = print_rio(ctl, &target, &served, &scan, merge, choice);
	else if (!status && !order->rio && !ctl->json && scan.count)
		scan_print_table(&scan);
	if (!status && !scan.count) {
		status = ctl_say(CTL_NOTHING,
		                 "%s answers, but no device is there: look at the wires and the "
		                 "supply of the devices, or name another target with -t TARGET",
		                 target.name);
		scan_board(target.name);
	}
	target_close(&target);
	scan_free(&scan);
	return status;
}

int verb_scan(struct ctl *ctl, int argc, char **argv)
{
	struct scan_order order = {.timeout_ns = OPEN_TIMEOUT_NS};
	struct scan_choice choice = {0};
	struct scan_merge merge = {0};
	int c, status = CTL_DONE;

	while ((c = target_option(ctl, argc, argv, "riBL:M:R:W:", &order.timeout_ns)) != -1) {
		if (c == 'r')
			order.rio = true;
		else if (c == 'W')
			ctl->until_ns = ows_now() + ctl_option_seconds(ctl, c);
		else if (c == 'i')
			choice.inputs_only = true;
		else if (c == 'B')
			choice.bits = true;
		else if (c == 'L')
			order.aliases = optarg;
		else if (c == 'M' && !merge.file)
			merge.file = optarg;
		else if (c == 'M')
			return ctl_usage(ctl, "--merge is given twice");
		else if (c == 'R' && merge.pair_count < SCAN_PAIRS)
			merge.pair[merge.pair_count++] = optarg;
		else
			return ctl_usage(ctl, "at most %d devices are replaced at once",
			                 SCAN_PAIRS);
	}
	order.names = argv + optind;
	order.name_count = (unsigned)(argc - optind);
	if (order.name_count && order.rio)
		return ctl_usage(ctl, "%s: --rio looks at all of a target", argv[optind]);
	if (order.rio ? ctl->json : choice.inputs_only || choice.bits)
		return ctl_usage(ctl, order.rio     ? "--rio prints no JSON"
		                      : choice.bits ? "--bits goes with --rio"
		                                    : "-i goes with --rio");
	if (merge.file && !order.rio)
		return ctl_usage(ctl, "--merge goes with --rio: it makes a configuration");
	if (merge.pair_count && !merge.file)
		return ctl_usage(ctl,
		                 "--replace goes with --merge FILE, whose devices it replaces");
	if (merge.file)
		status = scan_merge_open(&merge);
	if (!status)
		status = scan_look(ctl, &order, choice, &merge);
	if (status && order.rio)
		warn_of_empty_file();
	scan_merge_close(&merge);
	return status;
}
