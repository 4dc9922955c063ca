/* SPDX-License-Identifier: MIT */
/* Reads what a message asks for, and writes the answer. */
#include <string.h>

#include "src/faces/mqtt/ask.h"

const char *ask_read(struct ask *ask, const char *text, size_t len, bool plain)
{
	const struct body_member *value;

	ask->value = "";
	ask->id = NULL;
	if (len > ASK_MOST)
		return "it is longer than 1024 bytes";
	memcpy(ask->text, text, len);
	ask->text[len] = '\0';
	ask->value = ask->text;
	if (plain || ask->text[0] != '{')
		return NULL;
	if (body_parse(ask->text, len, &ask->body)) {
		ask->value = "";
		return "it is no JSON as expected: {\"v\":21.5} or {\"v\":21.5,\"id\":\"7\"}";
	}
	ask->id = body_find(&ask->body, "id");
	value = body_find(&ask->body, "v");
	ask->value = value && value->kind != BODY_NULL ? value->text : "";
	return NULL;
}

void ask_id_json(struct json *json, const struct ask *ask)
{
	if (!ask->id)
		return;
	if (ask->id->kind == BODY_NUMBER)
		json_number(json, "id", ask->id->text);
	else
		json_string(json, "id", ask->id->text);
}

void ask_answer_json(struct json *json, const struct ask *ask, const char *why)
{
	json_bool(json, "taken", !why);
	if (ask->value)
		json_string(json, "set", ask->value);
	if (why)
		json_string(json, "why", why);
	ask_id_json(json, ask);
}
