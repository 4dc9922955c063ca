/* SPDX-License-Identifier: MIT */
/* Replaces a device in the paths of its items. */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "src/config/edit/edit_block.h"
#include "src/config/edit/edit_device.h"
#include "src/config/edit/rio_write.h"
#include "src/config/edit/steady.h"

/* The path of an item, as it is written and in parts. */
struct item_path {
	const char *text;
	struct path path;
};

/* Does the item name that device? Then `in` has its path. */
static bool has_device(const struct rio_node *item, const uint8_t rom[ROM_LEN],
                       struct item_path *in)
{
	const struct rio_node *node = rio_child(item, option_table[OPT_PATH].key);

	if (item->kind != RIO_BLOCK || !node ||
	    path_split(node->value, strlen(node->value), &in->path))
		return false;
	in->text = node->value;
	return in->path.has_rom && !memcmp(in->path.rom, rom, ROM_LEN);
}

/* The first item with that device, and its path; NULL: there is none. */
static struct rio_node *edit_device_find(const struct rio *rio, const uint8_t rom[ROM_LEN],
                                         struct item_path *in)
{
	struct rio_node *item = edit_items(rio);

	while (item && !has_device(item, rom, in))
		item = rio_next(item);
	return item;
}

static bool are_too_many(const struct rio *rio, const uint8_t rom[ROM_LEN])
{
	struct item_path in;
	unsigned count = 0;

	for (struct rio_node *item = edit_device_find(rio, rom, &in); item; item = rio_next(item))
		count += has_device(item, rom, &in);
	return count > EDIT_REPLACE_MAX;
}

/* Write the path with the new id, in the old one's place and format, and keep its bus. */
static bool new_path(const struct item_path *in, const uint8_t rom[ROM_LEN], const char *location,
                     char *out, size_t size)
{
	const char *old = in->text;
	const struct path *path = &in->path;
	char before[ROM_TEXT_MAX], after[ROM_TEXT_MAX];
	const char *bus = strstr(old, "bus."), *rest = path->last.text + path->last.len;
	enum rom_format format;
	int head = (int)(path->last.text - old), n;

	for (format = ROM_F_I; format < ROM_FIC; format++)
		if (rom_print(path->rom, format, before) == (int)path->last.len &&
		    !strncasecmp(before, path->last.text, path->last.len))
			break;
	rom_print(rom, format, after);
	if (path->bus < 0 || !bus || bus > path->last.text || !*location)
		n = snprintf(out, size, "%.*s%s%s", head, old, after, rest);
	else
		n = snprintf(out, size, "%.*s%s%.*s%s%s", (int)(bus - old), old, location,
		             (int)(path->last.text - bus - (long)strcspn(bus, "/")),
		             bus + strcspn(bus, "/"), after, rest);
	return n >= 0 && (size_t)n < size;
}

/* In the first item that has it. */
static int replace_in(struct rio **rio, const uint8_t before[ROM_LEN], const uint8_t after[ROM_LEN],
                      const char *location, struct config_report *report)
{
	char text[PATH_LEN_MAX + 64];
	struct item_path in;
	struct rio_node *item = edit_device_find(*rio, before, &in);

	assert(item); /* it was there, and has its path still */
	if (!new_path(&in, after, location, text, sizeof(text))) {
		report_error(report, (struct rio_position){0}, "the path \"%s\" would be too long",
		             in.text);
		return -EINVAL;
	}
	return rio_set_text(rio, item, option_table[OPT_PATH].key, text);
}

static int replace_all(struct rio **rio, const uint8_t before[ROM_LEN],
                       const uint8_t after[ROM_LEN], const char *location,
                       struct config_report *report)
{
	struct steady steady;
	struct item_path in;
	int err = steady_begin(*rio, &steady);

	if (err)
		return err;
	do
		err = replace_in(rio, before, after, location, report);
	while (!err && edit_device_find(*rio, before, &in));
	return steady_end(rio, &steady, err);
}

int edit_replace(struct rio **rio, const uint8_t before[ROM_LEN], const uint8_t after[ROM_LEN],
                 const char *location, struct config_report *report)
{
	struct item_path in, taken;
	char old[ROM_TEXT_MAX], new[ROM_TEXT_MAX];
	int err = -EINVAL;

	rom_print(before, ROM_F_I, old);
	rom_print(after, ROM_F_I, new);
	if (!edit_device_find(*rio, before, &in))
		report_error(report, (struct rio_position){0}, "no item has the device %s", old);
	else if (edit_device_find(*rio, after, &taken))
		report_error(report, (struct rio_position){0}, "the device %s has items already",
		             new);
	else if (before[0] != after[0])
		report_error(report, (struct rio_position){0},
		             "%s and %s are of different families, which have different properties",
		             old, new);
	else if (are_too_many(*rio, before))
		report_error(report, (struct rio_position){0},
		             "more than %d items have the device %s", EDIT_REPLACE_MAX, old);
	else
		err = replace_all(rio, before, after, location, report);
	return err;
}
