/* SPDX-License-Identifier: MIT */
/* May this request do what it asks? By headers that only the page sends, and the person. */
#pragma once

#include "src/faces/web/person.h"

struct request;

#define GUARD_WORDS 256

/*
 * Each returns 0, with who it is in person; or the status of the refusal, with the reason in words.
 * Each looks at the head alone, and reads /etc/passwd and /etc/group.
 */

/* Of a request with an effect. */
unsigned guard_person(const struct request *request, enum person_deed deed, char person[PERSON],
                      char words[GUARD_WORDS]);
/* The same of a POST, whose body is JSON. */
unsigned guard_post(const struct request *request, enum person_deed deed, char person[PERSON],
                    char words[GUARD_WORDS]);
