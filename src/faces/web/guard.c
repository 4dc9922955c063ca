/* SPDX-License-Identifier: MIT */
/* Refuses what a page of another site could make a browser send, and persons without the right. */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "src/faces/web/guard.h"
#include "src/faces/web/http.h"

static bool is_json(const char *type)
{
	size_t len = strlen("application/json");

	return type && strncasecmp(type, "application/json", len) == 0 &&
	       (!type[len] || type[len] == ';' || type[len] == ' ');
}

unsigned guard_person(const struct request *request, enum person_deed deed, char person[PERSON],
                      char words[GUARD_WORDS])
{
	const char *mark = http_header(request, "X-Owsd"), *why = "expected the header X-Owsd: 1";

	if (mark && strcmp(mark, "1") == 0 &&
	    person_may_do(http_descriptor(request), &request->web->face->config->web, deed,
	                  http_named(request), person, &why))
		return 0;
	snprintf(words, GUARD_WORDS, "%s", why);
	return 403;
}

unsigned guard_post(const struct request *request, enum person_deed deed, char person[PERSON],
                    char words[GUARD_WORDS])
{
	if (is_json(http_header(request, "Content-Type")))
		return guard_person(request, deed, person, words);
	snprintf(words, GUARD_WORDS, "expected Content-Type: application/json");
	return 415;
}
