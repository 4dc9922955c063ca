/* SPDX-License-Identifier: MIT */
/*
 * POST api/config/draft: one edit of a text that a browser has, and a check of the result. Nothing
 * on disk is read or changed but what a check of any configuration reads (/etc/passwd, /etc/group).
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "src/faces/web/problems.h"

#define DRAFT_MAX (1u << 20) /* bytes of a text */

struct request;

int draft_post(struct request *request);

/* Is it UTF-8 without NUL, so that JSON can carry it unchanged? */
#define DRAFT_NO_TEXT "the file has bytes that are not UTF-8: save it as UTF-8 by an editor first"
bool draft_is_text(const char *text, size_t len);
