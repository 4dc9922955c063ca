/* SPDX-License-Identifier: MIT */
/*
 * scan --rio --merge FILE: prints the file with its new devices added, and reports which are
 * missing.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/config/edit/edit.h"
#include "src/config/edit/edit_block.h"
#include "src/config/edit/edit_device.h"
#include "src/config/read/load.h"
#include "src/config/read/rio_file.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/scan/scan_merge.h"

/* --- What each device comes to --------------------------------------------------------------- */

static int merge_find(const struct merge_device *list, unsigned count, const uint8_t rom[ROM_LEN])
{
	for (unsigned i = 0; i < count; i++)
		if (memcmp(list[i].rom, rom, ROM_LEN) == 0)
			return (int)i;
	return -1;
}

static const char *merge_replace(struct merge_device *known, unsigned known_count,
                                 struct merge_device *found, unsigned found_count,
                                 const struct merge_pair *pair)
{
	int old = merge_find(known, known_count, pair->old_rom);
	int new = merge_find(found, found_count, pair->new_rom);

	if (old < 0)
		return "no item of the file has this device";
	if (known[old].fate == MERGE_STAYS)
		return "the old device is still there";
	if (new < 0)
		return "the new device was not found";
	if (found[new].fate == MERGE_STAYS)
		return "the new device has items in the file already";
	if (known[old].rom[0] != found[new].rom[0])
		return "they are of different families, which have different properties";
	if (known[old].fate == MERGE_REPLACED || found[new].fate == MERGE_REPLACED)
		return "one of the two is in another --replace too";
	known[old].fate = found[new].fate = MERGE_REPLACED;
	known[old].other = new;
	found[new].other = old;
	return NULL;
}

static unsigned merge_count(const struct merge_device *list, unsigned n, uint8_t family,
                            enum merge_fate fate)
{
	unsigned sum = 0;

	for (unsigned i = 0; i < n; i++)
		sum += list[i].rom[0] == family && list[i].fate == fate;
	return sum;
}

/* Note where as many devices of a family are new as are missing: they may be replacements. */
static void pair_up(struct merge_device *known, unsigned known_count, struct merge_device *found,
                    unsigned found_count)
{
	for (unsigned i = 0; i < known_count; i++) {
		uint8_t family = known[i].rom[0];
		unsigned missing = merge_count(known, known_count, family, MERGE_MISSING);

		if (known[i].fate != MERGE_MISSING ||
		    missing != merge_count(found, found_count, family, MERGE_NEW))
			continue;
		known[i].pairs = missing;
		for (unsigned k = 0; k < found_count; k++)
			if (found[k].rom[0] == family && found[k].fate == MERGE_NEW)
				found[k].pairs = missing;
	}
}

const char *merge_decide(struct merge_device *known, unsigned known_count,
                         struct merge_device *found, unsigned found_count,
                         const struct merge_pair *pairs, unsigned pair_count, unsigned *wrong)
{
	for (unsigned i = 0; i < known_count; i++) {
		bool there = merge_find(found, found_count, known[i].rom) >= 0;

		known[i].fate = there ? MERGE_STAYS : MERGE_MISSING;
		known[i].other = -1;
		known[i].pairs = 0;
	}
	for (unsigned i = 0; i < found_count; i++) {
		bool there = merge_find(known, known_count, found[i].rom) >= 0;

		found[i].fate = there ? MERGE_STAYS : MERGE_NEW;
		found[i].other = -1;
		found[i].pairs = 0;
	}
	for (*wrong = 0; *wrong < pair_count; ++*wrong) {
		const char *fault = merge_replace(known, known_count, found, found_count,
		                                  &pairs[*wrong]);

		if (fault)
			return fault;
	}
	pair_up(known, known_count, found, found_count);
	return NULL;
}

/* --- The file -------------------------------------------------------------------------------- */

#define NAMES_TEXT 160

/* One item of the file. */
struct item {
	char *name, *path;
	int device; /* index in known; -1: no id in the path, no device with its alias found */
};

struct work {
	struct scan_merge *merge;
	const struct scan *scan;
	struct item *item;
	unsigned item_count;
	struct merge_device *known, *found; /* found: the same order as scan->device */
	unsigned known_count;
	struct merge_pair pair[SCAN_PAIRS];
	struct scan_names names;
};

static bool is_stdout(const char *file)
{
	struct stat out, there;

	return !fstat(STDOUT_FILENO, &out) && S_ISREG(out.st_mode) && !stat(file, &there) &&
	       out.st_dev == there.st_dev && out.st_ino == there.st_ino;
}

int scan_merge_open(struct scan_merge *merge)
{
	struct config_report report = {.line = ctl_report};
	struct config *config = NULL;
	char *text;
	size_t len;
	int err;

	if (is_stdout(merge->file))
		return ctl_fail(
			"%s is where the output goes: what was in it is lost before it can be "
			"read. Write to another file, and rename that",
			merge->file);
	err = rio_read(merge->file, &report, &text, &len);
	if (err)
		return err == -ENOMEM ? ctl_fail("no memory") : CTL_FAILED;
	err = config_parse(merge->file, text, len, &report, &config);
	if (!err) {
		config_free(config);
		err = rio_parse(merge->file, text, len, &report, &merge->rio);
	}
	free(text);
	if (err == -ENOMEM)
		return ctl_fail("no memory");
	return err ? CTL_USAGE : CTL_DONE;
}

void scan_merge_close(struct scan_merge *merge)
{
	if (merge->rio)
		rio_free(merge->rio);
}

static const char *id_of(const struct merge_device *device, char text[ROM_TEXT_MAX])
{
	rom_print(device->rom, ROM_F_I, text);
	return text;
}

static int add_known(struct work *work, const uint8_t rom[ROM_LEN])
{
	for (unsigned i = 0; i < work->known_count; i++)
		if (!memcmp(work->known[i].rom, rom, ROM_LEN))
			return (int)i;
	memcpy(work->known[work->known_count].rom, rom, ROM_LEN);
	return (int)work->known_count++;
}

/* The device of an item: by the id in its path, or by an alias that a found device has. */
static int device_of(struct work *work, const char *text)
{
	struct path path;

	if (path_split(text, strlen(text), &path) || !path.device.len)
		return -1;
	if (path.has_rom)
		return add_known(work, path.rom);
	for (unsigned i = 0; i < work->scan->count; i++) {
		const char *alias = work->scan->device[i].alias;

		if (*alias && strlen(alias) == path.last.len &&
		    !memcmp(alias, path.last.text, path.last.len))
			return add_known(work, work->found[i].rom);
	}
	return -1;
}

static const char *text_of_key(const struct rio_node *item, const char *key)
{
	const struct rio_node *node = rio_child(item, key);

	return node ? node->value : "";
}

static void collect_items(struct work *work)
{
	struct path path;
	unsigned count = 0;

	for (const struct rio_node *i = edit_items(work->merge->rio); i; i = rio_next(i))
		count++;
	work->item = ctl_need(calloc((size_t)count + 1, sizeof(*work->item)));
	work->known = ctl_need(calloc((size_t)count + 1, sizeof(*work->known)));
	work->found = ctl_need(calloc((size_t)work->scan->count + 1, sizeof(*work->found)));
	scan_names_init(&work->names, count + scan_items_most(work->scan));
	for (unsigned i = 0; i < work->scan->count; i++) {
		const char *text = work->scan->device[i].path;

		if (!path_split(text, strlen(text), &path))
			memcpy(work->found[i].rom, path.rom, ROM_LEN);
	}
	for (const struct rio_node *i = edit_items(work->merge->rio); i; i = rio_next(i)) {
		struct item *item = &work->item[work->item_count++];

		item->name = ctl_need(strdup(text_of_key(i, "Name")));
		item->path = ctl_need(strdup(text_of_key(i, "Path")));
		item->device = device_of(work, item->path);
		scan_names_add(&work->names, item->name);
	}
}

static void free_work(struct work *work)
{
	for (unsigned i = 0; i < work->item_count; i++) {
		free(work->item[i].name);
		free(work->item[i].path);
	}
	free(work->item);
	free(work->known);
	free(work->found);
	scan_names_free(&work->names);
}

static bool parse_id(const char *text, size_t len, uint8_t rom[ROM_LEN])
{
	if (len && *text == '/') {
		text++;
		len--;
	}
	return rom_parse(text, len, rom) == 0;
}

/* OLD is an id, or the name of a signal of the device. */
static bool parse_pair(struct work *work, const char *text, struct merge_pair *pair)
{
	const char *equals = strrchr(text, '=');
	size_t len = equals ? (size_t)(equals - text) : 0;

	if (!len || !parse_id(equals + 1, strlen(equals + 1), pair->new_rom)) {
		ctl_fail("--replace %s: expected OLD=NEW, as 28.551DDF030000=28.67C6697351FF",
		         ctl_word(text));
		return false;
	}
	if (parse_id(text, len, pair->old_rom))
		return true;
	for (unsigned i = 0; i < work->item_count; i++) {
		const struct item *item = &work->item[i];

		if (item->device < 0 || strlen(item->name) != len ||
		    memcmp(item->name, text, len) != 0)
			continue;
		memcpy(pair->old_rom, work->known[item->device].rom, ROM_LEN);
		return true;
	}
	ctl_fail("--replace %s: %.*s is neither the id of a device nor the name of a signal of one",
	         text, (int)len, text);
	return false;
}

static int decide(struct work *work)
{
	const struct scan_merge *merge = work->merge;
	const char *fault;
	unsigned wrong;

	for (unsigned i = 0; i < merge->pair_count; i++)
		if (!parse_pair(work, merge->pair[i], &work->pair[i]))
			return CTL_USAGE;
	fault = merge_decide(work->known, work->known_count, work->found, work->scan->count,
	                     work->pair, merge->pair_count, &wrong);
	return fault ? ctl_fail("--replace %s: %s", merge->pair[wrong], fault) : CTL_DONE;
}

/* "room1, room2 and 3 more": the signals of a device of the file. */
static const char *names_of(const struct work *work, int device, char text[NAMES_TEXT])
{
	unsigned more = 0;
	size_t used = 0;

	text[0] = '\0';
	for (unsigned i = 0; i < work->item_count; i++) {
		const char *name = work->item[i].name;

		if (work->item[i].device != device)
			continue;
		if (more || used + strlen(name) + 24 > NAMES_TEXT)
			more++;
		else
			used += (size_t)snprintf(text + used, NAMES_TEXT - used, "%s%s",
			                         used ? ", " : "", name);
	}
	if (more)
		snprintf(text + used, NAMES_TEXT - used, " and %u more", more);
	return text;
}

static void suggest(const struct work *work, const struct merge_device *missing, const char *names)
{
	char old[ROM_TEXT_MAX], new[ROM_TEXT_MAX];

	id_of(missing, old);
	for (unsigned i = 0; i < work->scan->count; i++) {
		const struct merge_device *found = &work->found[i];

		if (found->fate != MERGE_NEW || found->rom[0] != missing->rom[0])
			continue;
		id_of(found, new);
		ctl_fail(
			"replaced? %s: %s is missing, %s of the same family is new; if it took the "
			"place: --replace %s=%s",
			names, old, new, old, new);
	}
}

static void report_missing(const struct work *work)
{
	char names[NAMES_TEXT], id[ROM_TEXT_MAX];

	for (unsigned i = 0; i < work->known_count; i++) {
		const struct merge_device *device = &work->known[i];

		if (device->fate != MERGE_MISSING)
			continue;
		names_of(work, (int)i, names);
		ctl_fail("missing: %s: %s was not found; its items stay", names, id_of(device, id));
		if (device->pairs)
			suggest(work, device, names);
	}
	for (unsigned i = 0; i < work->item_count; i++)
		if (work->item[i].device < 0)
			ctl_fail("not judged: %s: its path, %s, has no id of a device",
			         work->item[i].name, work->item[i].path);
}

static int replace_device(struct work *work, unsigned known)
{
	const struct merge_device *old = &work->known[known], *new = &work->found[old->other];
	char names[NAMES_TEXT], id[2][ROM_TEXT_MAX];
	struct config_report report = {.line = ctl_report};
	int err = edit_replace(&work->merge->rio, old->rom, new->rom,
	                       work->scan->device[old->other].location, &report);

	if (!err)
		ctl_fail("replaced: %s: %s by %s", names_of(work, (int)known, names),
		         id_of(old, id[0]), id_of(new, id[1]));
	return err;
}

static void make_items(struct work *work, unsigned i, struct scan_choice choice)
{
	const struct scan_device *device = &work->scan->device[i];
	unsigned first = work->names.count, n;

	if (!scan_make_items(&work->names, device, choice))
		return;
	n = work->names.count - first;
	ctl_fail("new: %s%s%s: %s (%s)", work->names.name[first], n > 1 ? " to " : "",
	         n > 1 ? work->names.name[first + n - 1] : "", device->path + 1, device->type);
}

static int merge_devices(struct work *work, struct scan_choice choice)
{
	unsigned named = work->names.count;
	int err = 0;

	for (unsigned i = 0; i < work->known_count && !err; i++)
		if (work->known[i].fate == MERGE_REPLACED)
			err = replace_device(work, i);
	for (unsigned i = 0; i < work->scan->count && !err; i++)
		if (work->found[i].fate == MERGE_NEW)
			make_items(work, i, choice);
	if (!err)
		err = scan_add_items(&work->merge->rio, &work->names);
	return err || work->names.count == named ? err : edit_count(&work->merge->rio);
}

int scan_merge(struct scan_merge *merge, const struct scan *scan, struct scan_choice choice)
{
	struct work work = {.merge = merge, .scan = scan};
	int err, status;

	collect_items(&work);
	status = decide(&work);
	if (!status) {
		err = merge_devices(&work, choice);
		if (err)
			status = ctl_fail("%s: %s", merge->file, strerror(-err));
	}
	if (!status)
		status = scan_check(merge->rio, merge->file);
	if (!status) {
		report_missing(&work);
		fwrite(merge->rio->text, 1, merge->rio->len, stdout);
	}
	free_work(&work);
	return status;
}
