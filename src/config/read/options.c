/* SPDX-License-Identifier: MIT */
/* The table of all keys of the configuration, and how the values of a block are read by it. */
#include <ctype.h>
#include <float.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "src/config/read/build.h"
#include "src/config/read/options.h"
#include "src/ground/text/distance.h"

#define DAY 86400.0

/* The struct of each place. */
typedef struct config of_DRIVER;
typedef struct config_item of_ITEM;
#define BLOCK(name, key, member, ...) typedef struct config_##member of_##name;
#include "src/config/read/option_list.h"

const struct option_def option_table[OPTION_COUNT_ALL] = {
#define RANGE(least_, most_) .least = (least_), .most = (most_)
#define STORE_OF(member) \
	_Generic((member), \
		const char *: STORE_TEXT, \
		bool: STORE_BOOL, \
		unsigned: STORE_UNSIGNED, \
		int64_t: STORE_NS, \
		double: STORE_DOUBLE)
#define HAS(of, member) .has = offsetof(struct of, member)
#define AT(of, member) .at = offsetof(struct of, member)
#define OTHER(name, key_, place_, kind_, ...) \
	[OPT_##name] = { \
		.key = (key_), .place = PLACE_##place_, .kind = OPTION_##kind_, __VA_ARGS__},
/* NOLINTBEGIN(bugprone-macro-parentheses): the names of members */
#define BLOCK(name, key_, member, ...) \
	OTHER(name, key_, DRIVER, BLOCK, .inside = PLACE_##name, \
	      .offset = offsetof(struct config, member), \
	      .has = offsetof(struct config, member.given), __VA_ARGS__)
/* NOLINTEND(bugprone-macro-parentheses) */
#define OPTION(name, key_, place_, kind_, member, ...) \
	OTHER(name, key_, place_, kind_, .offset = offsetof(of_##place_, member), \
	      .store = STORE_OF(((of_##place_ *)0)->member), __VA_ARGS__)
#include "src/config/read/option_list.h"
};

const char *option_place_name(enum option_place place)
{
	static const char *const names[PLACE_COUNT] = {
		[PLACE_DRIVER] = "OwsDrv",
		[PLACE_ITEM] = "Item",
		[PLACE_BUS] = "Bus",
#define BLOCK(name, key, ...) [PLACE_##name] = (key),
#include "src/config/read/option_list.h"
	};

	return names[place];
}

int option_find(enum option_place place, const char *key)
{
	for (int i = 0; i < OPTION_COUNT_ALL; i++)
		if (option_table[i].place == place && !strcmp(option_table[i].key, key))
			return i;
	return -1;
}

bool option_is_block(const struct rio_node *node, enum option option)
{
	return node->kind == RIO_BLOCK && !strcmp(node->key, option_table[option].key);
}

const struct option_def *option_single(const char *name)
{
	int option = option_find(PLACE_DRIVER, name);

	return option >= 0 && option_table[option].inside ? &option_table[option] : NULL;
}

unsigned options_blocks(const struct rio_node *driver, enum option option)
{
	unsigned count = 0;

	for (const struct rio_node *node = driver->first; node; node = node->next)
		count += option_is_block(node, option);
	return count;
}

const char *option_nearest(enum option_place place, const char *key, char text[OPTION_NEAREST])
{
	unsigned least = UINT_MAX;
	size_t used = 0;

	for (int i = 0; i < OPTION_COUNT_ALL && used < OPTION_NEAREST; i++) {
		const char *known = option_table[i].key;
		unsigned distance;

		if (option_table[i].place != place)
			continue;
		distance = text_distance(key, known);
		/* the beginning of a long key means that key */
		if (distance > 1 + strlen(known) / 4 && strlen(key) > 2 &&
		    !strncasecmp(known, key, strlen(key)))
			distance = 1;
		if (distance > 1 + strlen(known) / 4 || distance > least)
			continue;
		used = distance < least ? 0 : used;
		used += (size_t)snprintf(text + used, OPTION_NEAREST - used, "%s%s",
		                         used ? " or " : "", known);
		least = distance;
	}
	return used ? text : NULL;
}

const char *option_of_alarm(const char *key, const char *value, char text[OPTION_NEAREST])
{
	bool sets = strchr(value, '=') && !strpbrk(value, " \t"),
	     latch = !strncasecmp(value, "latch", 5);

	if (sets)
		return option_table[latch ? OPT_RESET_LATCH : OPT_SET_ALARM].key;
	if (latch)
		return option_table[OPT_LATCH_ALARM].key;
	if (!strcasecmp(value, "por") || !strncasecmp(value, "por.", 4))
		return option_table[OPT_POR_ALARM].key;
	if (!strcasestr(key, "alarm"))
		return NULL;
	if (strcasestr(key, "latch"))
		return option_table[OPT_LATCH_ALARM].key;
	if (strcasestr(key, "por"))
		return option_table[OPT_POR_ALARM].key;
	if (strcasestr(key, "set"))
		return option_table[OPT_SET_ALARM].key;
	const char *near = option_nearest(PLACE_ITEM, key, text);

	return near ? near : "Alarm, LatchAlarm, PorAlarm, SetAlarm or ResetLatch";
}

static void report_unknown(const struct rio_node *node, enum option_place place,
                           struct config_report *report)
{
	char text[OPTION_NEAREST], alarm_text[OPTION_NEAREST];
	const char *nearest = option_nearest(place, node->key, text);
	const char *value = node->kind == RIO_STRING ? node->value : "";
	const char *alarm = place == PLACE_ITEM ? option_of_alarm(node->key, value, alarm_text)
	                                        : NULL;

	if (alarm)
		report_error(report, node->at,
		             "unknown key %s in %s looks like part of an alarm, which would be "
		             "off: write %s in its place",
		             node->key, option_place_name(place), alarm);
	else if (node->kind == RIO_BLOCK && option_find(PLACE_DRIVER, node->key) >= 0)
		report_warning(report, node->at,
		               "unknown key %s in %s is ignored; is a '}' missing before line %d?",
		               node->key, option_place_name(place), node->at.line);
	else if (nearest)
		report_warning(report, node->at, "unknown key %s in %s is ignored; is it %s?",
		               node->key, option_place_name(place), nearest);
	else
		report_warning(report, node->at, "unknown key %s in %s is ignored", node->key,
		               option_place_name(place));
}

static bool parse_hex(const char *text, double *number)
{
	char *end;

	if (strncasecmp(text, "0x", 2) != 0 || !isxdigit((unsigned char)text[2]))
		return false;
	*number = (double)strtoull(text + 2, &end, 16);
	return !*end;
}

static bool parse_number(const char *text, enum ows_type type, double *number)
{
	int64_t value;

	if (value_parse(type, text, &value))
		return false;
	*number = value_number(type, value);
	return true;
}

static bool is_any(const struct option_def *def)
{
	return def->least >= def->most;
}

static bool is_word_of(const char *words, const char *text)
{
	size_t len = strlen(text);

	while (strcspn(words, " ") != len || strncmp(words, text, len) != 0) {
		words = strstr(words, " or ");
		if (!words)
			return false;
		words += strlen(" or ");
	}
	return true;
}

static bool parse_kind(const struct option_def *def, const char *text, double *number)
{
	int type;

	switch (def->kind) {
	case OPTION_TEXT:
		return !def->words || is_word_of(def->words, text);
	case OPTION_BLOCK:
		return true;
	case OPTION_COUNT:
		if (!parse_hex(text, number) && !parse_number(text, OWS_LARGE, number))
			return false;
		break;
	case OPTION_SECONDS:
	case OPTION_NUMBER:
		if (!parse_number(text, OWS_DOUBLE, number))
			return false;
		break;
	case OPTION_FLAG:
		return parse_number(text, OWS_BOOL, number);
	case OPTION_TYPE:
		type = value_type_parse(text);
		*number = type;
		return type >= 0;
	case OPTION_IO:
		*number = !strcmp(text, "output");
		return !strcmp(text, "output") || !strcmp(text, "input");
	}
	return is_any(def) || (*number >= def->least && *number <= def->most);
}

static void report_expected(const struct option_def *def, const struct rio_node *node,
                            struct config_report *report)
{
	const char *expected = "";
	char range[80];

	switch (def->kind) {
	case OPTION_COUNT:
		snprintf(range, sizeof(range), "a whole number from %.0f to %.0f", def->least,
		         def->most);
		expected = def->most == UINT32_MAX ? "a whole number such as 0x0018" : range;
		break;
	case OPTION_SECONDS:
		snprintf(range, sizeof(range), "seconds from %.10g to %.10g", def->least,
		         def->most);
		expected = range;
		break;
	case OPTION_NUMBER:
		expected = is_any(def) ? "a number" : "a number, not negative";
		break;
	case OPTION_FLAG:
		expected = "on or off";
		break;
	case OPTION_TYPE:
		expected = "bool, byte, short, long, word, dword, float, double, large or string";
		break;
	case OPTION_IO:
		expected = "input or output";
		break;
	case OPTION_TEXT:
		expected = def->words;
		break;
	case OPTION_BLOCK:
		return;
	}
	report_error(report, node->value_at, "%s \"%s\": expected %s", def->key, node->value,
	             expected);
}

void option_begin(const struct option_def *def, struct option_value *value)
{
	*value = (struct option_value){.text = ""};
	if (def->preset)
		parse_kind(def, def->preset, &value->number);
}

void option_read(const struct option_def *def, const struct rio_node *node,
                 struct option_value *value, struct config_report *report)
{
	double number = value->number;

	if (value->node && !def->repeats) {
		report_error(report, node->at, "%s is given twice, first in line %d", def->key,
		             value->node->at.line);
		return;
	}
	if (!value->node)
		value->node = node;
	if (node->broken && node->kind != RIO_BLOCK)
		return;
	if ((node->kind == RIO_BLOCK) != (def->kind == OPTION_BLOCK) || node->kind == RIO_LIST) {
		report_error(report, node->value_at, "%s: expected %s", def->key,
		             def->kind == OPTION_BLOCK ? "a block in { }" : "one value");
		if (def->kind == OPTION_BLOCK)
			value->node = NULL;
		return;
	}
	if (def->kind == OPTION_BLOCK)
		return;
	if (!parse_kind(def, node->value, &number)) {
		report_expected(def, node, report);
		return;
	}
	value->text = node->value;
	value->number = number;
	value->given = true;
}

static const char *take_text(struct build *build, const struct option_def *def,
                             const struct option_value *value)
{
	const char *why;

	if (!value->given)
		return def->preset;
	/* an empty text that is no value of its own has to pass, too, and then means no key */
	why = def->check && (*value->text || !(def->empty || def->needed)) ? def->check(value->text)
	                                                                   : NULL;
	if (why && strpbrk(value->text, "@?")) /* as in a URL with a password */
		report_error(build->report, value->node->value_at, "%s: %s", def->key, why);
	else if (why)
		report_error(build->report, value->node->value_at, "%s \"%s\": %s", def->key,
		             value->text, why);
	return *value->text || def->empty ? build_keep(build, value->text, strlen(value->text))
	                                  : def->preset;
}

/* The member at an offset of the struct of a block. */
static void *member(void *block, size_t offset)
{
	return (char *)block + offset;
}

static const void *member_of(const void *block, size_t offset)
{
	return (const char *)block + offset;
}

void option_take(struct build *build, const struct option_def *def,
                 const struct option_value *value, void *to)
{
	void *at = member(to, def->offset);

	switch (def->store) {
	case STORE_NONE:
		break;
	case STORE_TEXT:
		*(const char **)at = take_text(build, def, value);
		break;
	case STORE_BOOL:
		*(bool *)at = value->number != 0;
		break;
	case STORE_UNSIGNED:
		*(unsigned *)at = (unsigned)value->number;
		break;
	case STORE_NS:
		*(int64_t *)at = option_ns(value);
		break;
	case STORE_DOUBLE:
		*(double *)at = value->number;
		break;
	}
	if (def->has)
		*(bool *)member(to, def->has) = def->kind == OPTION_BLOCK ? value->node != NULL
		                                                          : value->given;
	if (def->at)
		*(struct config_spot *)member(to, def->at) = option_spot(value);
}

/* 0 or 1 of a flag, seconds of a time. */
static double number_of(const struct option_def *def, const void *from)
{
	const void *at = member_of(from, def->offset);

	switch (def->store) {
	case STORE_NONE:
	case STORE_TEXT:
		break;
	case STORE_BOOL:
		return *(const bool *)at;
	case STORE_UNSIGNED:
		return *(const unsigned *)at;
	case STORE_NS:
		return (double)*(const int64_t *)at / 1e9;
	case STORE_DOUBLE:
		return *(const double *)at;
	}
	return 0;
}

static const char *text_of(const struct option_def *def, const void *from)
{
	return *(const char *const *)member_of(from, def->offset);
}

bool option_is_given(const struct option_def *def, const void *from)
{
	if (def->has)
		return *(const bool *)member_of(from, def->has);
	/* a time below 0: not given, and its default is not of the table */
	return def->store == STORE_TEXT ? text_of(def, from) != NULL
	                                : def->store != STORE_NS || number_of(def, from) >= 0;
}

bool option_is_preset(const struct option_def *def, const void *from)
{
	struct option_value value;

	if (!def->preset || def->store == STORE_TEXT)
		return !option_is_given(def, from) ||
		       (def->preset && !strcmp(text_of(def, from), def->preset));
	option_begin(def, &value);
	return number_of(def, from) == value.number;
}

const char *option_text(const struct option_def *def, const void *from, char room[VALUE_TEXT_MAX])
{
	double number = number_of(def, from);

	if (!option_is_given(def, from))
		return "";
	switch (def->kind) {
	case OPTION_TEXT:
		return text_of(def, from);
	case OPTION_FLAG:
		return number != 0 ? "on" : "off";
	case OPTION_IO:
		return number != 0 ? "output" : "input";
	case OPTION_TYPE:
		return value_type_name((enum ows_type)(int)number);
	case OPTION_COUNT:
	case OPTION_SECONDS:
	case OPTION_NUMBER:
	case OPTION_BLOCK:
		break;
	}
	value_to_text(OWS_DOUBLE, value_of_double(number), room);
	return room;
}

/* A block says what it cannot be without. */
static void check_needed(struct build *build, const struct option_def *def,
                         const struct option_value *value, const struct rio_node *block)
{
	if (block && def->needed && (!value->given || !*value->text))
		report_error(build->report, block->at, "%s without %s: write it, as %s \"%s\"",
		             option_place_name(def->place), def->key, def->key, def->needed);
}

void options_read(struct build *build, const struct rio_node *block, enum option_place place,
                  struct option_value *values, void *to)
{
	for (int i = 0; i < OPTION_COUNT_ALL; i++)
		option_begin(&option_table[i], &values[i]);
	for (const struct rio_node *node = block ? block->first : NULL; node; node = node->next) {
		int option = option_find(place, node->key);

		if (option >= 0)
			option_read(&option_table[option], node, &values[option], build->report);
		else if (*node->key)
			report_unknown(node, place, build->report);
	}
	for (int i = 0; i < OPTION_COUNT_ALL; i++)
		if (option_table[i].place == place && to) {
			option_take(build, &option_table[i], &values[i], to);
			check_needed(build, &option_table[i], &values[i], block);
		}
}
