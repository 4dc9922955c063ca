/* SPDX-License-Identifier: MIT */
/* Changes of a configuration file, key by key; all the rest of it stays byte for byte. */
#include <errno.h>
#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "src/config/edit/edit.h"
#include "src/config/edit/edit_block.h"
#include "src/config/edit/rio_write.h"
#include "src/config/edit/steady.h"
#include "src/ground/signal/value.h"

const char edit_empty[] = "OwsDrv {\n"
			  "  Version                 1.00\n"
			  "  TargetName              \"localhost:4304\"\n"
			  "}\n";

/* The place of errors in edits: the command line, not a place in the file. */
static const struct rio_position command_line;

static bool has_control(const char *text)
{
	for (; *text; text++)
		if (((unsigned char)*text < ' ' && *text != '\t') || *text == 0x7f)
			return true;
	return false;
}

static bool is_plain_word(const char *text)
{
	return *text && !text[strcspn(text, " \t\r\n{}[]\"#\\")];
}

/* The key and value of "KEY=VALUE", checked against the table; the key is cut off in place. */
static int split_setting(char *setting, enum option_place place, enum option *option,
                         const char **value, struct config_report *report)
{
	char *equals = strchr(setting, '=');
	const char *nearest;
	char text[OPTION_NEAREST];
	int found;

	if (!equals) {
		report_error(report, command_line, "\"%s\": expected KEY=VALUE", setting);
		return -EINVAL;
	}
	*equals = '\0';
	*value = equals + 1;
	found = option_find(place, setting);
	if (found >= 0 && option_table[found].kind == OPTION_BLOCK) {
		report_error(report, command_line, "%s is a block and has no value", setting);
		return -EINVAL;
	}
	if (found < 0) {
		nearest = place == PLACE_ITEM ? option_of_alarm(setting, *value, text) : NULL;
		if (!nearest)
			nearest = option_nearest(place, setting, text);
		report_error(report, command_line, "there is no key %s%s%s%s", setting,
		             nearest ? "; is it " : "", nearest ? nearest : "", nearest ? "?" : "");
		return -EINVAL;
	}
	if (has_control(*value)) {
		report_error(report, command_line, "%s: control characters are not allowed",
		             setting);
		return -EINVAL;
	}
	*option = (enum option)found;
	return 0;
}

/* Put Type, IO or Uncached into the bits of IOType; false: the setting is none of these. */
static bool change_bits(enum option option, const char *value, unsigned long *bits)
{
	int type;
	int64_t flag;

	if (option == OPT_TYPE) {
		type = value_type_parse(value);
		if (type < 0)
			return false;
		*bits = (*bits & ~0x0ful) | (unsigned long)type;
		return true;
	}
	if (option == OPT_IO) {
		if (!strcmp(value, "output"))
			*bits = (*bits & ~0x10ul) | 0x20;
		else if (!strcmp(value, "input"))
			*bits = (*bits & ~0x20ul) | 0x10;
		else
			return false;
		return true;
	}
	if (option != OPT_UNCACHED || value_parse(OWS_BOOL, value, &flag))
		return false;
	*bits = (*bits & ~0x100ul) | (flag ? 0x100 : 0);
	return true;
}

static int edit_put_value(struct rio **rio, struct rio_node *block, enum option option,
                          const char *value)
{
	const char *key = option_table[option].key;
	const struct rio_node *old = rio_child(block, key);
	bool as_word = old ? old->kind == RIO_WORD : option_table[option].kind != OPTION_TEXT;

	return as_word && is_plain_word(value) ? rio_set(rio, block, key, value)
	                                       : rio_set_text(rio, block, key, value);
}

static int put_setting(struct rio **rio, struct rio_node *block, enum option option,
                       const char *value)
{
	const struct rio_node *io_type = rio_child(block, option_table[OPT_IO_TYPE].key);
	unsigned long bits;
	char text[24], *end;

	if (io_type && !rio_child(block, option_table[option].key)) {
		/* as the reader has it: 034 is 34 */
		bits = strtoul(io_type->value, &end,
		               strncasecmp(io_type->value, "0x", 2) ? 10 : 16);
		if (!*end && change_bits(option, value, &bits)) {
			snprintf(text, sizeof(text), "0x%04lX", bits);
			return edit_put_value(rio, block, OPT_IO_TYPE, text);
		}
	}
	return edit_put_value(rio, block, option, value);
}

/* Refuse the name of the driver for an item: it would hide the driver's own keys. */
static bool is_driver_name(const char *name, struct config_report *report)
{
	if (strcmp(name, EDIT_DRIVER) != 0)
		return false;
	report_error(report, command_line,
	             "no item can be named " EDIT_DRIVER
	             ": that stands for the driver itself, whose keys are "
	             "changed by config FILE set " EDIT_DRIVER " KEY=VALUE");
	return true;
}

/* Refuse settings that give one key twice: either value may be the intended one. */
static int check_once(const char *const *settings, unsigned count, struct config_report *report)
{
	for (unsigned i = 1; i < count; i++) {
		size_t len = strcspn(settings[i], "=");

		for (unsigned k = 0; k < i; k++)
			if (strcspn(settings[k], "=") == len &&
			    !memcmp(settings[i], settings[k], len)) {
				report_error(report, command_line, "%.*s is given twice", (int)len,
				             settings[i]);
				return -EINVAL;
			}
	}
	return 0;
}

static bool is_allow(const struct rio_node *node)
{
	return node->kind != RIO_BLOCK && !strcmp(node->key, option_table[OPT_CONTROL_ALLOW].key);
}

#define PATTERN "*?[\\" /* what makes a pattern of a name, for fnmatch() */

/* The pattern of a ControlAllow, which is its first word. */
static size_t pattern_of(const struct rio_node *node, const char **at)
{
	*at = node->value + strspn(node->value, " \t");
	return strcspn(*at, " \t");
}

static bool is_followed(const char *from, const char *to)
{
	return !strpbrk(from, PATTERN) && !strpbrk(to, PATTERN);
}

/* Put the new name of an item where a ControlAllow has the old one, unless one is a pattern. */
static int follow_name(struct rio **rio, const char *from, const char *to)
{
	const struct rio_node *driver = edit_driver(*rio), *node = driver ? driver->first : NULL;
	size_t from_len = strlen(from), len;
	const char *at;

	if (!is_followed(from, to))
		return 0;
	for (; node; node = node->next) {
		char *text = NULL, *quoted;
		int err;

		if (!is_allow(node))
			continue;
		len = pattern_of(node, &at);
		if (len != from_len || memcmp(at, from, len))
			continue;
		if (asprintf(&text, "%s%s", to, at + len) < 0)
			return -ENOMEM;
		quoted = rio_quote(text);
		err = quoted ? rio_replace(rio, node, quoted) : -ENOMEM;
		free(quoted);
		free(text);
		/* the nodes are new: look again for others */
		return err || !strcmp(from, to) ? err : follow_name(rio, from, to);
	}
	return 0;
}

/* Warn of patterns that give rights to one of the names, and do not follow it. */
static void warn_of_patterns(const struct rio *rio, const char *from, const char *to,
                             struct config_report *report)
{
	const struct rio_node *driver = edit_driver(rio), *node = driver ? driver->first : NULL;
	char pattern[RIO_VALUE_MAX + 1];
	const char *at;

	for (; node; node = node->next) {
		size_t len;
		bool fits;

		if (!is_allow(node))
			continue;
		len = pattern_of(node, &at);
		memcpy(pattern, at, len);
		pattern[len] = '\0';
		fits = fnmatch(pattern, to, 0) == 0;
		if ((strcmp(pattern, from) || !is_followed(from, to)) &&
		    (fnmatch(pattern, from, 0) == 0) != fits)
			report_warning(report, command_line,
			               "ControlAllow \"%s\" fits %s and not %s: look who may set "
			               "it now",
			               node->value, fits ? to : from, fits ? from : to);
	}
}

/* A key that may stand several times has no value of its own where it does: rights would go. */
static int check_single(const struct rio_node *block, enum option_place place, const char *key,
                        struct config_report *report)
{
	int option = option_find(place, key);
	const struct rio_node *node = rio_child(block, key);

	if (option < 0 || !option_table[option].repeats || !node || !rio_next(node))
		return 0;
	report_error(report, command_line, "%s stands more than once: change it in the text", key);
	return -EINVAL;
}

static int set_all(struct rio **rio, const char *name, const char *const *settings, unsigned count,
                   struct config_report *report)
{
	char current[RIO_VALUE_MAX + sizeof(EDIT_BUS)];
	int err = check_once(settings, count, report);

	if (strlen(name) >= sizeof(current)) {
		edit_no_item(*rio, name, report);
		return -EINVAL;
	}
	memcpy(current, name, strlen(name) + 1);
	if (!err)
		err = edit_make_block(rio, name);
	for (unsigned i = 0; i < count && !err; i++) {
		enum option_place place;
		struct rio_node *block = edit_block(*rio, current, &place, report);
		char *setting = block ? strdup(settings[i]) : NULL;
		const char *value;
		enum option option;

		if (!setting)
			return block ? -ENOMEM : -EINVAL;
		err = split_setting(setting, place, &option, &value, report);
		if (!err && option == OPT_NAME && place == PLACE_ITEM &&
		    is_driver_name(value, report))
			err = -EINVAL;
		if (!err)
			err = check_single(block, place, option_table[option].key, report);
		if (!err)
			err = put_setting(rio, block, option, value);
		/* the item has its new name from here on */
		if (!err && option == OPT_NAME) {
			warn_of_patterns(*rio, current, value, report);
			err = follow_name(rio, current, value);
			snprintf(current, sizeof(current), "%s", value);
		}
		if (!err && option == OPT_BUS_TARGET)
			snprintf(current, sizeof(current), EDIT_BUS "%s", value);
		free(setting);
	}
	return err;
}

int edit_set(struct rio **rio, const char *name, const char *const *settings, unsigned count,
             struct config_report *report)
{
	struct steady steady;
	int err = steady_begin(*rio, &steady);

	return err ? err : steady_end(rio, &steady, set_all(rio, name, settings, count, report));
}

int edit_rename(struct rio **rio, const char *name, const char *to, struct config_report *report)
{
	const char *setting;
	char *text = NULL;
	int err = -EINVAL;

	if (!edit_item(*rio, name)) {
		edit_no_item(*rio, name, report);
	} else if (!strcmp(name, to)) {
		report_error(report, command_line, "\"%s\" is the name that it has", name);
	} else if (edit_item(*rio, to)) {
		report_error(report, command_line, "there is an item \"%s\" already", to);
	} else if (asprintf(&text, "%s=%s", option_table[OPT_NAME].key, to) >= 0) {
		setting = text;
		err = edit_set(rio, name, &setting, 1, report);
		free(text);
	} else {
		err = -ENOMEM;
	}
	return err;
}

static int unset_all(struct rio **rio, const char *name, const char *const *keys, unsigned count,
                     struct config_report *report)
{
	int err = 0;

	for (unsigned i = 0; i < count && !err; i++) {
		enum option_place place;
		struct rio_node *block = edit_block(*rio, name, &place, report);
		struct rio_node *node = block ? rio_child(block, keys[i]) : NULL;

		if (!block)
			return -EINVAL;
		if (!node || node->kind == RIO_BLOCK) {
			report_error(report, command_line, "\"%s\" has no key %s", name, keys[i]);
			return -EINVAL;
		}
		err = check_single(block, place, keys[i], report);
		if (!err)
			err = rio_remove(rio, node);
	}
	return err;
}

int edit_unset(struct rio **rio, const char *name, const char *const *keys, unsigned count,
               struct config_report *report)
{
	struct steady steady;
	int err = steady_begin(*rio, &steady);

	return err ? err : steady_end(rio, &steady, unset_all(rio, name, keys, count, report));
}

int edit_count(struct rio **rio)
{
	struct rio_node *driver = edit_driver(*rio);
	char text[16];

	if (!driver || !rio_child(driver, option_table[OPT_ITEM_COUNT].key))
		return 0;
	snprintf(text, sizeof(text), "%u", options_blocks(driver, OPT_ITEM));
	return edit_put_value(rio, driver, OPT_ITEM_COUNT, text);
}

/* Are the types of the file written as bits? Then those of a new item are. */
static bool has_bits(const struct rio_node *driver)
{
	for (const struct rio_node *node = driver->first; node; node = node->next)
		if (node->kind == RIO_BLOCK && rio_child(node, option_table[OPT_IO_TYPE].key))
			return true;
	return false;
}

static int add_item(struct rio **rio, const char *name, const char *path, bool bits)
{
	const struct {
		enum option option;
		const char *value;
	} keys[] = {
		{OPT_NAME, name},
		{OPT_PATH, path},
		{bits ? OPT_IO_TYPE : OPT_TYPE, bits ? "0x0018" : "double"},
		{bits ? OPT_INIT_VALUE : OPT_IO, bits ? "" : "input"},
	};
	int err = rio_add(rio, edit_driver(*rio), "Item {\n}");

	for (size_t i = 0; i < sizeof(keys) / sizeof(keys[0]) && !err; i++)
		err = (keys[i].option == OPT_IO_TYPE ? rio_set : rio_set_text)(
			rio, edit_driver(*rio)->last, option_table[keys[i].option].key,
			keys[i].value);
	return err;
}

int edit_add(struct rio **rio, const char *name, const char *path, const char *const *settings,
             unsigned count, struct config_report *report)
{
	struct rio_node *driver = edit_driver(*rio);
	struct steady steady;
	int err;

	if (!driver) {
		report_error(report, command_line, "the file has no block " EDIT_DRIVER);
		return -EINVAL;
	}
	if (is_driver_name(name, report))
		return -EINVAL;
	if (edit_item(*rio, name)) {
		report_error(report, command_line, "there is an item \"%s\" already", name);
		return -EINVAL;
	}
	if (has_control(name) || has_control(path)) {
		report_error(report, command_line, "control characters are not allowed");
		return -EINVAL;
	}
	err = steady_begin(*rio, &steady);
	if (err)
		return err;
	err = add_item(rio, name, path, has_bits(driver));
	if (!err && count)
		err = set_all(rio, name, settings, count, report);
	err = steady_end(rio, &steady, err);
	return err ? err : edit_count(rio);
}

static struct rio_node *find_item_or_report(const struct rio *rio, const char *name,
                                            struct config_report *report)
{
	struct rio_node *item = edit_item(rio, name);

	if (!item)
		edit_no_item(rio, name, report);
	return item;
}

int edit_remove(struct rio **rio, const char *name, struct config_report *report)
{
	enum option_place place;
	struct rio_node *block = edit_block(*rio, name, &place, report);
	struct steady steady;
	int err;

	if (block && place == PLACE_DRIVER)
		report_error(report, command_line, EDIT_DRIVER " cannot be removed");
	if (!block || place == PLACE_DRIVER)
		return -EINVAL;
	err = steady_begin(*rio, &steady);
	if (err)
		return err;
	if (place == PLACE_ITEM)
		steady_remove(&steady, steady_index(*rio, block));
	err = steady_end(rio, &steady, rio_remove(rio, block));
	return err ? err : edit_count(rio);
}

static int move_item(struct rio **rio, struct rio_node *item, struct rio_node *there, bool behind)
{
	struct steady steady;
	int err = steady_begin(*rio, &steady);

	if (err)
		return err;
	steady_move(&steady, steady_index(*rio, item), steady_index(*rio, there) + behind);
	return steady_end(rio, &steady, rio_move(rio, item, there, behind));
}

int edit_move(struct rio **rio, const char *name, const char *other, bool behind,
              struct config_report *report)
{
	struct rio_node *item = find_item_or_report(*rio, name, report);
	struct rio_node *there = item ? find_item_or_report(*rio, other, report) : NULL;
	int err = there ? move_item(rio, item, there, behind) : -EINVAL;

	if (there && err == -EINVAL)
		report_error(report, command_line,
		             "\"%s\" and \"%s\" can only be moved on lines of their own", name,
		             other);
	return err;
}
