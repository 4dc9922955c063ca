/* SPDX-License-Identifier: MIT */
/* Collects what a check of a configuration reports, and asks the document what stands there. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/edit/edit_block.h"
#include "src/faces/web/problems.h"

static void collect(void *ctx, bool is_error, int line, int column, const char *text)
{
	struct problems *problems = ctx;
	struct problem *problem = &problems->list[problems->count];

	if (problems->count == PROBLEMS)
		return;
	*problem = (struct problem){
		.error = is_error, .line = line, .column = column, .text = strdup(text)};
	if (problem->text)
		problems->count++;
}

struct config_report problems_report(struct problems *problems)
{
	return (struct config_report){.problem = collect, .ctx = problems};
}

const char *problems_first(const struct problems *problems, int *line)
{
	*line = 0;
	for (unsigned i = 0; i < problems->count; i++)
		if (problems->list[i].error) {
			*line = problems->list[i].line;
			return problems->list[i].text;
		}
	return "";
}

void problems_free(struct problems *problems)
{
	for (unsigned i = 0; i < problems->count; i++)
		free(problems->list[i].text);
	problems->count = 0;
}

/* The byte of the text at that place; of a line without a column the first that is no blank. */
static size_t offset_of(const struct rio *rio, int line, int column)
{
	const char *at = rio->text, *end = rio->text + rio->len;

	for (int i = 1; i < line && at < end;) {
		size_t len = rio_line_end_length(at, end);

		i += len > 0;
		at += len ? len : 1;
	}
	while (!column && at < end && (*at == ' ' || *at == '\t'))
		at++;
	for (int i = 1; i < column && at < end && !rio_line_end_length(at, end); i++)
		do
			at++;
		while (at < end && ((unsigned char)*at & 0xc0) == 0x80);
	return (size_t)(at - rio->text);
}

static const struct rio_node *child_at(const struct rio_node *block, size_t offset)
{
	const struct rio_node *node = block ? block->first : NULL;

	while (node && (offset < node->begin || offset >= node->end))
		node = node->next;
	return node;
}

static void name_block(struct json *json, const struct rio_node *block)
{
	bool is_item = block && !strcmp(block->key, option_table[OPT_ITEM].key);
	bool is_bus = block && !strcmp(block->key, option_table[OPT_BUS].key);
	const struct rio_node *name = is_item  ? rio_child(block, option_table[OPT_NAME].key)
	                              : is_bus ? rio_child(block, option_table[OPT_BUS_TARGET].key)
	                                       : NULL;
	char text[sizeof(EDIT_BUS) + RIO_VALUE_MAX];

	json_string(json, "item", is_item && name ? name->value : NULL);
	snprintf(text, sizeof(text), EDIT_BUS "%s", name ? name->value : "");
	json_string(json, "block", is_bus ? text : is_item ? NULL : block ? block->key : NULL);
}

static void problems_show(struct json *json, const struct problem *problem, const struct rio *rio)
{
	size_t offset = rio && problem->line ? offset_of(rio, problem->line, problem->column) : 0;
	const struct rio_node *driver = NULL, *block = NULL, *key = NULL;

	if (rio && problem->line)
		driver = block = child_at(&rio->root, offset);
	if (block)
		key = child_at(block, offset);
	if (key && key->kind == RIO_BLOCK) {
		block = key;
		key = child_at(block, offset);
	}
	json_object(json, NULL);
	json_bool(json, "error", problem->error);
	json_int(json, "line", problem->line);
	json_int(json, "column", problem->column);
	json_string(json, "text", problem->text);
	name_block(json, driver ? block : NULL);
	json_string(json, "key", key && *key->key ? key->key : NULL);
	json_object_end(json);
}

void problems_json(struct json *json, const struct problems *problems, const struct rio *rio)
{
	json_array(json, "problems");
	for (unsigned i = 0; i < problems->count; i++)
		problems_show(json, &problems->list[i], rio);
	json_array_end(json);
}
