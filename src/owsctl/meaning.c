/* SPDX-License-Identifier: MIT */
/* What the value of a signal means, kept beside it and printed as JSON. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/owsctl/meaning.h"
#include "src/show/names.h"
#include "src/signal/value.h"

bool meaning_of(struct ows *h, const struct ows_info *info, struct meaning *meaning)
{
	char raw[NAMES_MAX];

	snprintf(raw, sizeof(raw), "%s%s", info->name, attribute_table[ATTR_RAW].name);
	*meaning = (struct meaning){
		.unit = strdup(info->unit),
		.description = strdup(info->description),
		.decimals = info->decimals,
		.raw = info->type == OWS_STRING ? -1 : ows_find(h, raw),
	};
	if (meaning->unit && meaning->description)
		return true;
	meaning_free(meaning);
	return false;
}

void meaning_free(struct meaning *meaning)
{
	free(meaning->unit);
	free(meaning->description);
	*meaning = (struct meaning){0};
}

static void raw_json(struct json *json, struct ows *h, int id, int64_t now_ns)
{
	char text[VALUE_TEXT_MAX];
	struct ows_value raw;
	int err = id < 0 ? -ENOENT : ows_get(h, id, now_ns, &raw);

	if ((err && err != -ESTALE) || !raw.measured_ns) {
		json_null(json, "raw");
		return;
	}
	value_to_text(OWS_DOUBLE, value_of_double(raw.number), text);
	json_number(json, "raw", text);
}

void meaning_json(struct json *json, struct ows *h, const struct meaning *meaning, int64_t now_ns)
{
	json_string(json, "unit", *meaning->unit ? meaning->unit : NULL);
	if (meaning->decimals >= 0)
		json_int(json, "decimals", meaning->decimals);
	else
		json_null(json, "decimals");
	json_string(json, "description", *meaning->description ? meaning->description : NULL);
	raw_json(json, h, meaning->raw, now_ns);
}
