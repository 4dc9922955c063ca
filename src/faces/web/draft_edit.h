/* SPDX-License-Identifier: MIT */
/* One edit of a draft: a text of a configuration that a browser has. */
#pragma once

#include "src/config/read/rio.h"
#include "src/faces/kit/body.h"

#define DRAFT_SETTINGS 64 /* keys of one edit */

/*
 * Do what the body asks by "do". check: leave the document. 0; -EINVAL: refused, and reported;
 * -ENOMEM or -EFBIG. Pure.
 */
int draft_edit(struct rio **rio, const struct body *body, struct config_report *report);
