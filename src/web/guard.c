/* SPDX-License-Identifier: MIT */
/* Refuses what a page of somebody else could make a browser send, and persons without the right. */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "src/web/guard.h"
#include "src/web/http.h"
#include "src/web/origin.h"

static bool is_json(const char *type)
{
	size_t len = strlen("application/json");

	return type && strncasecmp(type, "application/json", len) == 0 &&
	       (!type[len] || type[len] == ';' || type[len] == ' ');
}

unsigned guard_post(const struct request *request, enum person_deed deed, char person[PERSON],
                    char words[GUARD_WORDS])
{
	const char *mark = http_header(request, "X-Owsd"), *why = "";
	const char *origin = http_header(request, "Origin"), *host = http_header(request, "Host");
	unsigned status = 403;

	if (!is_json(http_header(request, "Content-Type"))) {
		why = "expected Content-Type: application/json";
		status = 415;
	} else if (!mark || strcmp(mark, "1") != 0) {
		why = "expected the header X-Owsd: 1";
	} else if (origin && (!host || !origin_same(origin, host))) {
		snprintf(words, GUARD_WORDS, "this command comes from another page: %s", origin);
		return status;
	} else if (person_may_do(http_descriptor(request), &request->web->face->config->web, deed,
	                         http_named(request), person, &why)) {
		return 0;
	}
	snprintf(words, GUARD_WORDS, "%s", why);
	return status;
}
