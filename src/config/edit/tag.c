/* SPDX-License-Identifier: MIT */
/* Prints the tag of a text. */
#include <inttypes.h>
#include <stdio.h>

#include "src/config/edit/tag.h"
#include "src/ground/signal/hash.h"

void tag_print(const char *bytes, size_t len, char text[TAG_TEXT])
{
	snprintf(text, TAG_TEXT, "%016" PRIx64, hash_text(HASH_BEGIN, bytes, len));
}
