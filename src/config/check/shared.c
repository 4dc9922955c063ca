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
	const struct config_item *item;
	struct shared_bits bits;
};

bool shared_bits(const char *text, struct shared_bits *bits)
{
	struct path_property property = property_look(text);
	const char *dot = strrchr(text, '.');
	const char *held = property.held;
	struct path path;
	size_t len;

	if (!property.exists || path_split(text, strlen(text), &path) || !path.device.len ||
	    !path.property.len)
		return false;
	if (dot && dot < path.property.text)
		dot = NULL;
	len = dot ? (size_t)(dot - path.property.text) : path.property.len;
	bits->element = dot ? dot + 1 : "";
	bits->where = path.has_rom ? hash_text(HASH_BEGIN, (const char *)path.rom, ROM_LEN)
	                           : hash_text(HASH_BEGIN, path.device.text, path.device.len);
	bits->where = *held ? hash_text(bits->where, held, strlen(held))
	                    : hash_text(bits->where, path.property.text, len);
	return true;
}

static int compare(const void *a, const void *b)
{
	const struct output *x = a, *y = b;

	if (x->bits.where != y->bits.where)
		return x->bits.where < y->bits.where ? -1 : 1;
	return (x->item > y->item) - (x->item < y->item);
}

static bool is_whole_register(const char *element)
{
	return !*element || !strcmp(element, "BYTE") || !strcmp(element, "ALL");
}

bool shared_overlap(const struct shared_bits *a, const struct shared_bits *b)
{
	return a->where == b->where &&
	       (is_whole_register(a->element) || is_whole_register(b->element) ||
	        !strcmp(a->element, b->element));
}

/* The nearest output before n that sets bits of it too; NULL: none. */
static const struct config_item *opponent(const struct output *outputs, unsigned n)
{
	for (unsigned i = n; i > 0 && n - i < PARTNERS; i--) {
		if (outputs[i - 1].bits.where != outputs[n].bits.where)
			break;
		if (shared_overlap(&outputs[i - 1].bits, &outputs[n].bits))
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

	for (unsigned i = 0; outputs && i < config->item_count; i++) {
		outputs[count].item = &config->items[i];
		count += config_item_takes_sets(&config->items[i]) &&
		         shared_bits(config->items[i].path, &outputs[count].bits);
	}
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
