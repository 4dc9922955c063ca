/* SPDX-License-Identifier: MIT */
/* Finds items that set the same bits of a device. */
#include <stdlib.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "src/config/check/property.h"
#include "src/config/check/shared.h"
#include "src/config/read/report.h"
#include "src/ground/signal/hash.h"

/* So many outputs of one register are compared with each other; a chip has no more switches. */
#define PARTNERS 64

struct output {
	uint64_t where; /* a hash of the device and of what holds the command */
	const struct config_item *item;
	const char *element; /* "3", "A", "BYTE"; "": all of it */
};

static bool find_output(const struct config_item *item, struct output *output)
{
	struct path_property property = property_look(item->path);
	const char *dot = strrchr(item->path, '.');
	const char *held = property.held;
	struct path path;
	size_t len;

	if (!config_item_takes_sets(item) || path_split(item->path, strlen(item->path), &path) ||
	    !path.device.len)
		return false;
	if (dot && dot < path.property.text)
		dot = NULL;
	len = dot ? (size_t)(dot - path.property.text) : path.property.len;
	output->item = item;
	output->element = dot ? dot + 1 : "";
	output->where = path.has_rom ? hash_text(HASH_BEGIN, (const char *)path.rom, ROM_LEN)
	                             : hash_text(HASH_BEGIN, path.device.text, path.device.len);
	output->where = *held ? hash_text(output->where, held, strlen(held))
	                      : hash_text(output->where, path.property.text, len);
	return true;
}

static int compare(const void *a, const void *b)
{
	const struct output *x = a, *y = b;

	if (x->where != y->where)
		return x->where < y->where ? -1 : 1;
	return (x->item > y->item) - (x->item < y->item);
}

static bool is_whole_register(const char *element)
{
	return !*element || !strcmp(element, "BYTE") || !strcmp(element, "ALL");
}

static bool overlap(const struct output *a, const struct output *b)
{
	return is_whole_register(a->element) || is_whole_register(b->element) ||
	       !strcmp(a->element, b->element);
}

/* The nearest output before n that sets bits of it too; NULL: none. */
static const struct config_item *opponent(const struct output *outputs, unsigned n)
{
	for (unsigned i = n; i > 0 && n - i < PARTNERS; i--) {
		if (outputs[i - 1].where != outputs[n].where)
			break;
		if (overlap(&outputs[i - 1], &outputs[n]))
			return outputs[i - 1].item;
	}
	return NULL;
}

static bool is_restored(const struct config_item *item)
{
	return item->restores && item->read_back_ns;
}

void shared_check(const struct config *config, const char *name, struct config_report *report)
{
	struct output *outputs = calloc(config->item_count + 1, sizeof(*outputs));
	unsigned count = 0;

	for (unsigned i = 0; outputs && i < config->item_count; i++)
		count += find_output(&config->items[i], &outputs[count]);
	if (outputs)
		qsort(outputs, count, sizeof(*outputs), compare);
	for (unsigned i = 0; i < count; i++) {
		const struct config_item *item = outputs[i].item, *other = opponent(outputs, i);

		if (!other || (name && strcmp(item->name, name) && strcmp(other->name, name)))
			continue;
		report_warning(report, (struct rio_position){config->file, item->line, 0},
		               "\"%s\" and \"%s\" in line %d set the same bits, and %s", item->name,
		               other->name, other->line,
		               is_restored(item) || is_restored(other)
		                       ? "Restore on undoes what the other commands: write Restore "
		                         "off, or keep one of them"
		                       : "the last command counts for both: keep one of them");
	}
	free(outputs);
}
