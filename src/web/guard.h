/* SPDX-License-Identifier: MIT */
/* May this POST do what it asks? By the page that it comes from, and the person that sends it. */
#pragma once

#include "src/web/person.h"

struct request;

#define GUARD_WORDS 256

/*
 * 0, with who it is in person; or the status of the refusal, with the reason in words. Looks at the
 * head alone. Reads /etc/passwd and /etc/group.
 */
unsigned guard_post(const struct request *request, enum person_deed deed, char person[PERSON],
                    char words[GUARD_WORDS]);
