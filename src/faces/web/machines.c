/* SPDX-License-Identifier: MIT */
/* This machine in a line, and the others. */
#include <microhttpd.h>

#include "src/faces/kit/look.h"
#include "src/faces/web/http.h"
#include "src/faces/web/others.h"
#include "src/faces/web/paths.h"
#include "src/faces/web/summary.h"

int machines_summary(struct request *request)
{
	const struct web *web = request->web;
	const struct face *face = web->face;
	struct summary summary;
	struct json json;
	char *text;
	size_t len;

	if (!json_start(&json, &text, &len))
		return MHD_NO;
	summary_make(&summary, face->arguments->instance, face->ows,
	             face->live && look_is_current(face), web->ids, ows_now());
	summary_json(&json, &summary);
	json_finish(&json);
	return http_json(request, 200, text, len);
}

int machines_others(struct request *request)
{
	struct json json;
	char *text;
	size_t len;

	if (!json_start(&json, &text, &len))
		return MHD_NO;
	json_array(&json, "others");
	others_json(request->web->others, &json, ows_now());
	json_array_end(&json);
	json_finish(&json);
	return http_json(request, 200, text, len);
}
