/* SPDX-License-Identifier: MIT */
/* Prints the tag of a text. */
#include <inttypes.h>
#include <stdio.h>

#include "src/config/tag.h"

void tag_print(const char *bytes, size_t len, char text[TAG_TEXT])
{
	uint64_t tag = TAG_BEGIN;

	for (size_t i = 0; i < len; i++)
		tag = tag_add(tag, (unsigned char)bytes[i]);
	snprintf(text, TAG_TEXT, "%016" PRIx64, tag);
}
