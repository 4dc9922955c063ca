/* SPDX-License-Identifier: MIT */
/* The special signals of a signal: its ages, counters and switches (section 9 of semantics.md). */
#include <microhttpd.h>
#include <stdio.h>

#include "src/faces/kit/look.h"
#include "src/faces/show/json.h"
#include "src/faces/show/names.h"
#include "src/faces/web/http.h"
#include "src/faces/web/paths.h"
#include "src/ground/signal/value.h"

/* The value itself is elsewhere; to read _Alarm would take it from other requests. */
static bool is_shown(enum attribute attribute)
{
	return !attribute_table[attribute].driver && attribute != ATTR_VALUE &&
	       attribute != ATTR_ALARM;
}

static void put_one(struct json *json, struct ows *h, const char *signal,
                    const struct attribute_def *def)
{
	char name[NAMES_MAX], text[VALUE_TEXT_MAX];
	struct ows_value value = {0};
	int id, err;

	snprintf(name, sizeof(name), "%s%s", signal, def->name);
	id = ows_find(h, name);
	err = id < 0 ? id : ows_get_text(h, id, ows_now(), &value, text, sizeof(text));
	json_object(json, NULL);
	json_string(json, "name", def->name);
	json_bool(json, "flag", def->type == OWS_BOOL);
	json_bool(json, "readable", def->readable);
	json_bool(json, "writable", def->writable);
	json_string(json, "value", err ? NULL : text);
	json_object_end(json);
}

int special_get(struct request *request)
{
	const struct face *face = request->web->face;
	const char *name = http_argument(request, "name");
	struct ows_info info;
	struct json json;
	char *text;
	size_t len;

	if (!look_is_current(face))
		return http_error(request, 503, "owsd %s is not running: start it",
		                  face->arguments->instance);
	if (!name || !names_info(face->ows, face->arguments->instance, name, &info))
		return http_error(request, 404, "expected name=: that of a signal");
	if (!json_start(&json, &text, &len))
		return MHD_NO;
	json_array(&json, "signals");
	for (int i = 0; i < ATTR_COUNT; i++)
		if (is_shown((enum attribute)i))
			put_one(&json, face->ows, info.name, &attribute_table[i]);
	json_array_end(&json);
	json_finish(&json);
	return http_json(request, 200, text, len);
}
