/* SPDX-License-Identifier: MIT */
/* Answers that need no bus: inputs of the table, and what clients read lately. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/chips/format.h"
#include "src/config/check/shared.h"
#include "src/daemon/serve/kept.h"
#include "src/ground/signal/hash.h"
#include "src/ground/signal/value.h"
#include "src/memory/shm/reader.h"

#define VOLATILE_NS (2 * NS_PER_S)
#define STATIC_NS (300 * NS_PER_S)

#define SETS 256
#define WAYS 4
#define WRITTEN 64
#define PATH_MAX_KEPT 88

struct entry {
	int64_t until_ns; /* 0: the entry is free */
	uint8_t path_len, device_len;
	uint8_t len;
	char path[PATH_MAX_KEPT];
	uint8_t text[KEPT_TEXT_MAX];
};

struct kept {
	const struct config *config;
	uint32_t *index; /* hash of paths: index of the item + 1 */
	uint32_t index_size;
	struct output {
		struct shared_bits bits;
		uint32_t record;
	} * outputs;
	uint32_t output_count;
	struct entry entries[SETS * WAYS];
	/* When a client wrote last: to a device, by the hash of its id; behind them: to any. */
	int64_t written_ns[WRITTEN + 1];
};

/* Parse a path. True: it names a part of the targets, and no bus. */
static bool canonical(const char *path, struct node *node)
{
	node_parse(path, strlen(path), node);
	return node->kind == NODE_TARGET && node->bus < 0;
}

static void index_item(struct kept *kept, uint32_t item)
{
	struct output *output = &kept->outputs[kept->output_count];
	struct node node;
	uint32_t at;

	output->record = item + 1;
	kept->output_count += kept->config->items[item].output &&
	                      shared_bits(kept->config->items[item].path, &output->bits);
	if (!canonical(kept->config->items[item].path, &node))
		return;
	at = hash_text(HASH_BEGIN, node.path, strlen(node.path));
	while (kept->index[at % kept->index_size])
		at++;
	kept->index[at % kept->index_size] = item + 1;
}

struct kept *kept_create(const struct config *config)
{
	struct kept *kept = calloc(1, sizeof(*kept));

	if (!kept)
		return NULL;
	kept->config = config;
	kept->index_size = 2 * config->item_count + 1;
	kept->index = calloc(kept->index_size, sizeof(*kept->index));
	kept->outputs = calloc(config->item_count + 1, sizeof(*kept->outputs));
	if (!kept->index || !kept->outputs) {
		kept_destroy(kept);
		return NULL;
	}
	for (uint32_t i = 0; i < config->item_count; i++)
		index_item(kept, i);
	return kept;
}

void kept_destroy(struct kept *kept)
{
	if (!kept)
		return;
	free(kept->outputs);
	free(kept->index);
	free(kept);
}

int kept_signal(const struct kept *kept, const char *path, bool output)
{
	uint32_t at = hash_text(HASH_BEGIN, path, strlen(path)), slot;
	struct node node;

	while ((slot = kept->index[at % kept->index_size]) != 0) {
		const struct config_item *item = &kept->config->items[slot - 1];

		at++;
		if (item->output != output)
			continue;
		/* most items have the path as the server writes it, and need no parser */
		if (strcmp(item->path, path) == 0 ||
		    (canonical(item->path, &node) && strcmp(node.path, path) == 0))
			return (int)slot;
	}
	return -1;
}

bool kept_has_outputs(const struct kept *kept)
{
	for (unsigned i = 0; i < kept->config->item_count; i++)
		if (kept->config->items[i].output)
			return true;
	return false;
}

int kept_changes(const struct kept *kept, const char *path)
{
	struct shared_bits bits;

	if (!shared_bits(path, &bits))
		return -1;
	for (uint32_t i = 0; i < kept->output_count; i++)
		if (shared_overlap(&kept->outputs[i].bits, &bits))
			return (int)kept->outputs[i].record;
	return -1;
}

int kept_by_alias(const struct kept *kept, int from, const uint8_t rom[ROM_LEN],
                  const char *property, struct node *output)
{
	char id[ROM_TEXT_MAX], path[ROM_TEXT_MAX + NODE_PATH_MAX];
	char other[ROM_TEXT_MAX + NODE_PATH_MAX];
	struct shared_bits bits, of;
	bool shares;

	rom_print(rom, ROM_F_I, id);
	snprintf(path, sizeof(path), "/%s%s", id, property);
	shares = shared_bits(path, &bits);
	for (int record = from; record <= (int)kept->config->item_count; record++) {
		const struct config_item *item = &kept->config->items[record - 1];

		if (!item->output || item->device)
			continue;
		node_parse(item->path, strlen(item->path), output);
		if (output->kind != NODE_TARGET || !output->has_device || output->has_rom)
			continue;
		snprintf(other, sizeof(other), "/%s%s", id, output->path + output->device_len);
		if (!strcmp(other, path) ||
		    (shares && shared_bits(other, &of) && shared_overlap(&of, &bits)))
			return record;
	}
	return -1;
}

static int64_t *last_write(struct kept *kept, const struct node *node)
{
	return &kept->written_ns[node->has_rom
	                                 ? hash_text(HASH_BEGIN, node->path, node->device_len) %
	                                           WRITTEN
	                                 : WRITTEN];
}

/* Does the signal hold the property's value unchanged? */
static bool holds(enum ows_type type, char property)
{
	switch (property) {
	case 'f':
	case 't':
	case 'p':
		return type == OWS_DOUBLE || type == OWS_FLOAT;
	case 'u':
	case 'i':
		return type != OWS_STRING && type != OWS_FLOAT && type != OWS_BOOL;
	case 'y':
		return type != OWS_STRING;
	default:
		return false;
	}
}

static int64_t life_ns(char life)
{
	return life == LIFE_STATIC ? STATIC_NS : life == LIFE_SECOND ? NS_PER_S : VOLATILE_NS;
}

static int find_signal(struct kept *kept, const struct image *image, const struct node *node,
                       int64_t now_ns, char *text, size_t room)
{
	int record = kept_signal(kept, node->path, false);
	struct ows_slot slot;
	enum ows_type type;

	if (record < 0)
		return -ENOENT;
	type = (enum ows_type)image->records[record].type;
	if (!holds(type, node->type) || !reader_slot(&image->records[record], &slot) ||
	    slot.sample.quality != OWS_Q_GOOD || !slot.sample.measured_ns ||
	    slot.sample.measured_ns <= *last_write(kept, node) ||
	    now_ns - slot.sample.measured_ns > life_ns(node->life))
		return -ENOENT;
	return format_number((uint8_t)node->type, value_number(OWS_DOUBLE, slot.attrs.raw), text,
	                     room);
}

static struct entry *set_of(struct kept *kept, const char *path, size_t len)
{
	return &kept->entries[hash_text(HASH_BEGIN, path, len) % SETS * WAYS];
}

static bool kept_is(const struct entry *entry, const char *path, size_t len)
{
	return entry->until_ns && entry->path_len == len && memcmp(entry->path, path, len) == 0;
}

int kept_find(struct kept *kept, const struct image *image, const struct node *node, int64_t now_ns,
              char *text, size_t room)
{
	size_t len = strlen(node->path);
	struct entry *entry;
	int n;

	if (!node->has_device || node->bus >= 0 || !node->type)
		return -ENOENT;
	n = find_signal(kept, image, node, now_ns, text, room);
	if (n >= 0)
		return n;
	entry = set_of(kept, node->path, len);
	for (int way = 0; way < WAYS; way++, entry++) {
		if (!kept_is(entry, node->path, len))
			continue;
		if (now_ns >= entry->until_ns || entry->len > room)
			return -ENOENT;
		memcpy(text, entry->text, entry->len);
		return entry->len;
	}
	return -ENOENT;
}

void kept_add(struct kept *kept, const struct node *node, int64_t measured_ns, const uint8_t *text,
              size_t len)
{
	size_t path_len = strlen(node->path);
	struct entry *set, *best;

	/* an alias may get another meaning; the life of an unknown property is not known */
	if (!node->has_rom || node->bus >= 0 || !node->type || path_len > PATH_MAX_KEPT ||
	    len > KEPT_TEXT_MAX || strcmp(node->path + node->device_len, "/present") == 0 ||
	    node->type == PROPERTY_ALIAS)
		return;
	best = set = set_of(kept, node->path, path_len);
	for (int way = 0; way < WAYS; way++) {
		if (kept_is(&set[way], node->path, path_len)) {
			best = &set[way];
			break;
		}
		if (set[way].until_ns < best->until_ns)
			best = &set[way];
	}
	best->until_ns = measured_ns + life_ns(node->life);
	best->path_len = (uint8_t)path_len;
	best->device_len = (uint8_t)node->device_len;
	best->len = (uint8_t)len;
	memcpy(best->path, node->path, path_len);
	memcpy(best->text, text, len);
}

/* An alias may name any device, so a write through an alias forgets all answers. */
void kept_forget(struct kept *kept, const struct node *node, int64_t now_ns)
{
	for (unsigned i = 0; !node->has_rom && i < WRITTEN; i++)
		kept->written_ns[i] = now_ns;
	*last_write(kept, node) = kept->written_ns[WRITTEN] = now_ns;
	for (unsigned i = 0; i < SETS * WAYS; i++) {
		struct entry *entry = &kept->entries[i];

		if (!node->has_rom || (entry->device_len == node->device_len &&
		                       memcmp(entry->path, node->path, node->device_len) == 0))
			entry->until_ns = 0;
	}
}
