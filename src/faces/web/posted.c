/* SPDX-License-Identifier: MIT */
/* Keeps the bytes of a body. */
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/web/head.h"
#include "src/faces/web/posted.h"

void posted_begin(struct posted *posted, size_t size, unsigned *large, bool may, int64_t now_ns)
{
	*posted = (struct posted){.size = size, .until_ns = now_ns + POSTED_S * NS_PER_S};
	if (size <= BODY_MAX)
		return;
	posted->dropped = !may || *large == POSTED_LARGE;
	if (posted->dropped)
		return;
	posted->large = large;
	++*large;
}

bool posted_add(struct posted *posted, const char *bytes, size_t len, int64_t now_ns)
{
	if (len > posted->size - posted->len || now_ns > posted->until_ns)
		return false;
	if (!posted->dropped && !posted->bytes)
		posted->bytes = malloc(posted->size);
	if (!posted->dropped && !posted->bytes)
		return false;
	if (!posted->dropped)
		memcpy(posted->bytes + posted->len, bytes, len);
	posted->len += len;
	return true;
}

void posted_free(struct posted *posted)
{
	if (posted->large)
		--*posted->large;
	free(posted->bytes);
	*posted = (struct posted){0};
}
