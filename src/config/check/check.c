/* SPDX-License-Identifier: MIT */
/* Checks paths, properties and directions of the items by the tables of the chip families. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/bus/backends.h"
#include "hal/chips/facts.h"
#include "hal/chips/find.h"
#include "hal/owfs/path.h"
#include "src/config/check/check.h"
#include "src/config/check/know.h"
#include "src/config/check/own.h"
#include "src/config/check/property.h"
#include "src/config/check/shared.h"
#include "src/config/check/targets.h"
#include "src/config/read/alarm.h"
#include "src/config/read/config.h"
#include "src/config/read/options.h"
#include "src/ground/signal/unit.h"

struct check {
	struct config_report *report;
	const struct config_item *item;
	struct rio_position position, path_position; /* of the item, of its Path */
	int64_t period_ns;
	bool caches; /* all targets are owsd's own buses, whose values have the age of the chip's */
	bool tables; /* a Bus names a file of sensors: devices may have more properties */
};

#define ID_DIGITS 12

/* How many of the first len letters are hexadecimal digits? */
static size_t digits_of(const char *text, size_t len)
{
	size_t n = 0;

	while (n < len && isxdigit((unsigned char)text[n]))
		n++;
	return n;
}

/* The text after a family that there is and a sign; NULL where the text is no id, by its begin. */
static const char *after_family(const char *text, size_t len, uint8_t *code)
{
	char digits[3] = {0};

	if (len < 3 || digits_of(text, 2) != 2 || (text[2] != '.' && text[2] != '-'))
		return NULL;
	memcpy(digits, text, 2);
	*code = (uint8_t)strtoul(digits, NULL, 16);
	return family_of(*code)->code == *code ? text + 3 : NULL;
}

/* The id that the kernel spells so: the last byte of the number first. */
static void from_kernel(uint8_t code, const char *digits, char text[ROM_TEXT_MAX])
{
	uint8_t rom[ROM_LEN] = {code};

	for (int i = 0; i < ID_DIGITS / 2; i++) {
		char byte[3] = {digits[ID_DIGITS - 2 - 2 * i], digits[ID_DIGITS - 1 - 2 * i]};

		rom[1 + i] = (uint8_t)strtoul(byte, NULL, 16);
	}
	rom_print(rom, ROM_F_I, text);
}

/* A component that is no id, but looks like one. */
static void check_component(const struct check *check, const char *text, size_t len)
{
	const char *name = check->item->name;
	uint8_t rom[ROM_LEN], code = 0;
	const char *rest = after_family(text, len, &code);
	size_t left = rest ? len - 3 : 0, digits;
	char right[ROM_TEXT_MAX];

	if (!rest || rom_parse(text, len, rom) == 0)
		return;
	digits = digits_of(rest, left);
	if (text[2] == '-' && left == ID_DIGITS && digits == left) {
		from_kernel(code, rest, right);
		report_warning(check->report, check->path_position,
		               "\"%s\": %.*s is the kernel's spelling of a device: write %s", name,
		               (int)len, text, right);
	} else if (digits == left && left >= 4) {
		report_warning(check->report, check->path_position,
		               "\"%s\": %.*s has %zu digits after its family and counts as an "
		               "alias; an id has %d: owsctl scan shows them",
		               name, (int)len, text, left, ID_DIGITS);
	} else if (left == ID_DIGITS && text[2] == '.' && digits >= left / 2) {
		report_warning(check->report, check->path_position,
		               "\"%s\": %.*s counts as an alias; an id has no digit '%c', only 0 "
		               "to 9 and A to F",
		               name, (int)len, text, rest[digits]);
	}
}

static void check_ids(const struct check *check)
{
	const char *at = check->item->path;

	while (*at) {
		size_t len = strcspn(at, "/");

		check_component(check, at, len);
		at += len + (at[len] == '/');
	}
}

/* Where that stands, or the item if its key is absent. */
static struct rio_position position_at(const struct check *check, struct config_spot at)
{
	return at.line ? (struct rio_position){check->position.file, at.line, at.column}
	               : check->position;
}

/* A property that is named at `what`: "" or the key of an alarm, with a blank behind it. */
static void check_property(const struct check *check, struct rio_position position,
                           const char *path, const char *what, const char *property)
{
	struct path_property found = property_look(path);

	if (found.exists)
		return;
	if (*found.nearest)
		report_warning(check->report, position,
		               "\"%s\": %sa %s has no %s; did you mean %s?", check->item->name,
		               what, found.type, property, found.nearest);
	else if (!check->tables)
		report_warning(check->report, position,
		               "\"%s\": %sowsd knows no %s of a %s: check its spelling",
		               check->item->name, what, property, found.type);
}

static void check_direction(const struct check *check)
{
	const struct config_item *item = check->item;
	struct path_property found = property_look(item->path);

	if (item->output && !found.writable)
		report_warning(check->report, check->path_position,
		               "\"%s\" is an output, but %s cannot be written: write IO input",
		               item->name, strrchr(item->path, '/') + 1);
	else if (item->writable && !found.writable)
		report_warning(check->report, check->path_position,
		               "\"%s\" is Writable, but %s cannot be written: write Writable off",
		               item->name, strrchr(item->path, '/') + 1);
	else if (item->readable && !found.readable)
		report_warning(check->report, check->path_position,
		               "\"%s\" is read, but %s can only be written: write IO output",
		               item->name, strrchr(item->path, '/') + 1);
}

/* A unit that nothing converts to, or that other programs spell otherwise. */
static void check_unit(const struct check *check)
{
	const struct config_item *item = check->item;
	const char *symbol = item->unit ? unit_symbol(item->unit) : NULL;
	double factor, offset;
	struct quantity quantity;
	char known[128];

	if (!item->unit || !*item->unit || item->type == OWS_STRING)
		return;
	if (!scale_changes(&item->scale) && quantity_of(item->path, &quantity) && *quantity.unit &&
	    !unit_convert(quantity.unit, item->unit, &factor, &offset)) {
		unit_list(quantity.unit, known, sizeof(known));
		report_warning(check->report, check->position,
		               "\"%s\": Unit \"%s\" is shown beside a value in %s: write %s, or "
		               "Scale too",
		               item->name, item->unit, quantity.unit,
		               *known ? known : quantity.unit);
	} else if (symbol && strcmp(symbol, item->unit) != 0) {
		report_warning(check->report, check->position,
		               "\"%s\": Unit \"%s\": other programs know it as %s", item->name,
		               item->unit, symbol);
	}
}

/* So long owsd's own buses give a value again that was measured (docs/semantics.md 6). */
static int64_t cached_ns(const struct check *check)
{
	uint8_t life = property_look(check->item->path).life;

	if (!check->caches || check->item->fresh)
		return 0;
	return life == LIFE_VOLATILE ? 2 * NS_PER_S : life == LIFE_SECOND ? NS_PER_S : 0;
}

/* Of an output that is not read in each cycle: would it be stale between two looks? */
static void check_age_of_output(const struct check *check)
{
	const struct config_item *item = check->item;
	double back = (double)item->read_back_ns / 1e9, stale = (double)item->stale_after_ns / 1e9;

	if (item->stale_after_ns && item->stale_after_ns <= item->read_back_ns)
		report_warning(
			check->report, check->position,
			"\"%s\" is stale before it is read back, each %g s: write StaleAfter "
			"%g or more, or ReadBack %g",
			item->name, back, back * 1.5, stale / 2);
}

/* Would its value be stale between two readings? */
static void check_age(const struct check *check)
{
	const struct config_item *item = check->item;
	bool by_alarm = item->alarm && item->per_factor == 1;
	int64_t every_ns = by_alarm ? CONFIG_ALARM_READ_NS : item->per_factor * check->period_ns;
	int64_t often = item->stale_after_ns / 2 / check->period_ns, due_ns = every_ns;
	char factor[64] = "";

	if (!by_alarm)
		every_ns *= cached_ns(check) / every_ns + 1;
	if (!item->readable)
		check_age_of_output(check);
	if (!item->readable || !item->stale_after_ns || item->stale_after_ns > every_ns)
		return;
	often = often > 2 ? often : by_alarm ? 2 : 1;
	if (item->stale_after_ns > due_ns)
		snprintf(factor, sizeof(factor), ", or Uncached on");
	else if (by_alarm || often < item->per_factor)
		snprintf(factor, sizeof(factor), ", or PerFactor %lld%s", (long long)often,
		         every_ns > due_ns ? " and Uncached on" : "");
	report_warning(check->report, check->position,
	               "\"%s\" is stale before it is read again, each %g s%s: write StaleAfter %g "
	               "or more%s",
	               item->name, (double)every_ns / 1e9,
	               by_alarm ? " unless its alarm comes" : "", (double)every_ns / 1e9 * 1.5,
	               factor);
}

/* A property that there is and that does not fit what the key is for. */
static void check_purpose(const struct check *check, struct rio_position position, const char *path,
                          const char *key, const char *property, uint8_t purpose)
{
	static const char *const words[] = {
		[ALARM_LATCH] = "is no latch",
		[ALARM_CLEARS] = "clears no latch",
		[ALARM_POR] = "does not show a restart",
	};
	struct path_property found = property_look(path);
	char like[PROPERTY_NEAREST];

	bool named = purpose == ALARM_LATCH && property_of_alarm(path, ALARM_STAYS, like);

	if (purpose && !(found.alarm & purpose) &&
	    (named || property_of_alarm(path, purpose, like)))
		report_warning(check->report, position, "\"%s\": %s: %s %s of a %s: write %s",
		               check->item->name, key, property, words[purpose], found.type, like);
}

/* The property of a key of the alarm, whose value may be property=value. */
static void check_alarm(const struct check *check, enum option option, const char *string,
                        struct config_spot at, uint8_t purpose)
{
	const char *key = option_table[option].key, *property, *value;
	bool writes = option != OPT_LATCH_ALARM;
	struct rio_position position = position_at(check, at);
	char path[ALARM_PATH], what[32], why[PROPERTY_NEAREST];

	property = alarm_path(check->item, string, path);
	if (!property)
		return;
	if (*property == '/') {
		report_warning(check->report, position,
		               "\"%s\": %s \"%s\" is a property of the device: write it without "
		               "the / before it",
		               check->item->name, key, string);
		return;
	}
	snprintf(what, sizeof(what), "%s: ", key);
	check_property(check, position, path, what, property);
	if (!property_look(path).exists)
		return;
	if (writes && !property_look(path).writable) {
		report_warning(check->report, position,
		               "\"%s\": %s%s cannot be written, so the alarm cannot be served",
		               check->item->name, what, property);
		return;
	}
	check_purpose(check, position, path, key, property, purpose);
	value = strchr(string, '=');
	if (value && !value[1])
		report_warning(check->report, position,
		               "\"%s\": %s \"%s\" has nothing behind the '=', and nothing is "
		               "written; expected property=value",
		               check->item->name, key, string);
	else if (value && !property_takes(path, value + 1, why))
		report_warning(check->report, position, "\"%s\": %s \"%s\": %s of a %s%s",
		               check->item->name, key, string, property, property_look(path).type,
		               why);
}

static void check_alarms(const struct check *check)
{
	const struct config_item *item = check->item;
	char path[ALARM_PATH], like[PROPERTY_NEAREST];
	const char *latch = alarm_path(item, item->latch_alarm, path);

	check_alarm(check, OPT_LATCH_ALARM, item->latch_alarm, item->latch_at, ALARM_LATCH);
	check_alarm(check, OPT_POR_ALARM, item->por_alarm, item->por_at, ALARM_POR);
	check_alarm(check, OPT_SET_ALARM, item->set_alarm, item->set_at, 0);
	check_alarm(check, OPT_RESET_LATCH, item->reset_latch, item->reset_at, ALARM_CLEARS);
	if (!item->latch_stays || (item->reset_latch && *item->reset_latch))
		return;
	if (property_look(path).alarm & ALARM_CLEARS)
		snprintf(like, sizeof(like), "%s=0", latch);
	else if (!property_of_alarm(path, ALARM_CLEARS, like))
		return;
	report_warning(check->report,
	               position_at(check, item->reset_latch ? item->reset_at : item->latch_at),
	               "\"%s\": ResetLatch is %s, and %s stays set: the alarm comes once; write "
	               "ResetLatch with %s",
	               item->name, item->reset_latch ? "empty" : "not defined", latch, like);
}

static void check_item(const struct check *check)
{
	static const char simultaneous[] = "simultaneous/";
	const struct config_item *item = check->item;
	struct quantity quantity;
	struct path path;

	if (path_split(item->path, strlen(item->path), &path))
		return;
	check_ids(check);
	if (path.property.len)
		check_property(check, check->path_position, item->path, "", path.property.text);
	if (!path.device.len && item->readable &&
	    !strncmp(path.property.text, simultaneous, strlen(simultaneous)))
		report_warning(check->report, check->path_position,
		               "\"%s\": %s begins conversions and shows no value: write IO output, "
		               "or the Path of a device",
		               item->name, item->path);
	check_direction(check);
	check_unit(check);
	if (item->type == OWS_STRING && quantity_of(item->path, &quantity))
		report_warning(
			check->report, check->position,
			"\"%s\" is a number, and a string shows it as text: write Type double",
			item->name);
	if (item->type != OWS_STRING && property_look(item->path).text)
		report_warning(check->report, check->position,
		               "\"%s\" is a text or a list, and no %s: write Type string",
		               item->name, value_type_name(item->type));
	check_age(check);
	if (item->alarm)
		check_alarms(check);
}

void config_check_items(struct config *config, const char *name, struct config_report *report)
{
	struct check check = {.report = report, .period_ns = config->period_ns, .caches = true};
	struct config_report silent = {0};

	for (unsigned i = 0; i < config->target_count; i++)
		check.caches &= bus_caches(config->targets[i].text);
	for (unsigned i = 0; i < config->bus_count; i++)
		for (unsigned k = 0; k < config->buses[i].option_count; k++)
			check.tables |= !strcmp(config->buses[i].options[k].key,
			                        option_table[OPT_BUS_SENSORS].key);
	for (unsigned i = 0; i < config->item_count; i++) {
		bool asked = !name || !strcmp(config->items[i].name, name);

		know_item(&config->items[i], config->file, asked ? report : &silent);
		check.item = &config->items[i];
		check.position = (struct rio_position){config->file, check.item->line, 0};
		check.path_position = position_at(&check, check.item->path_at);
		if (asked)
			check_item(&check);
	}
	shared_check(config, name, report);
}

int config_check(struct config *config, struct config_report *report)
{
	int err = config_check_targets(config, report);

	if (!err)
		err = config_check_own(config, report);
	if (err)
		return err;
	config_check_items(config, NULL, report);
	return 0;
}
