/* SPDX-License-Identifier: MIT */
/* Keeps the identities of items over an edit. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/edit/edit_block.h"
#include "src/config/edit/rio_write.h"
#include "src/config/edit/steady.h"

unsigned steady_index(const struct rio *rio, const struct rio_node *item)
{
	unsigned index = 0;

	for (const struct rio_node *i = edit_items(rio); i && i != item; i = rio_next(i))
		index++;
	return index;
}

/* The text of the item's path as an identity; "": none. */
static void find_path(const struct rio_node *item, char text[IDENTITY_MAX])
{
	const struct rio_node *node = rio_child(item, option_table[OPT_PATH].key);
	struct path path;

	*text = '\0';
	if (node && !path_split(node->value, strlen(node->value), &path))
		identity_of_path(&path, text);
}

int steady_begin(const struct rio *rio, struct steady *steady)
{
	unsigned count = steady_index(rio, NULL), n = 0;
	struct identity *items = calloc(count + 1, sizeof(*items));
	char(*texts)[IDENTITY_MAX] = calloc(count + 1, sizeof(*texts)), text[IDENTITY_MAX];
	int err = items && texts ? 0 : -ENOMEM;

	*steady = (struct steady){count, texts};
	for (const struct rio_node *i = edit_items(rio); i && !err; i = rio_next(i), n++) {
		const struct rio_node *given = rio_child(i, option_table[OPT_IDENTITY].key);

		find_path(i, texts[n]);
		items[n] = (struct identity){given ? given->value : NULL, texts[n], 0};
	}
	if (!err)
		err = identities_number(items, count);
	for (unsigned i = 0; i < count && !err; i++) {
		identity_text(&items[i], text);
		snprintf(texts[i], IDENTITY_MAX, "%s", items[i].number ? text : "");
	}
	free(items);
	return err ? steady_end(NULL, steady, err) : 0;
}

void steady_remove(struct steady *steady, unsigned item)
{
	steady->count--;
	memmove(steady->identity[item], steady->identity[item + 1],
	        (steady->count - item) * sizeof(*steady->identity));
}

void steady_move(struct steady *steady, unsigned item, unsigned there)
{
	char text[IDENTITY_MAX];

	there -= there > item;
	memcpy(text, steady->identity[item], sizeof(text));
	steady_remove(steady, item);
	memmove(steady->identity[there + 1], steady->identity[there],
	        (steady->count - there) * sizeof(*steady->identity));
	memcpy(steady->identity[there], text, sizeof(text));
	steady->count++;
}

/* Write down the first identity that would change. Returns 1 after that, 0 if there is none. */
static int keep_one(struct rio **rio, const struct steady *was)
{
	struct rio_node *item = edit_items(*rio);
	struct steady is;
	unsigned i = 0;
	int err = steady_begin(*rio, &is);

	if (err)
		return err;
	for (; i < was->count && i < is.count; i++, item = rio_next(item))
		if (*was->identity[i] && *is.identity[i] &&
		    strcmp(was->identity[i], is.identity[i]) != 0)
			break;
	if (i < was->count && i < is.count)
		err = rio_set_text(rio, item, option_table[OPT_IDENTITY].key, was->identity[i]);
	free(is.identity);
	return err ? err : i < was->count && i < is.count;
}

int steady_end(struct rio **rio, struct steady *steady, int err)
{
	/* what one item keeps may leave the next one's number free again: look anew */
	for (int kept = 1; !err && kept > 0; err = kept < 0 ? kept : 0)
		kept = keep_one(rio, steady);
	free(steady->identity);
	*steady = (struct steady){0};
	return err;
}
