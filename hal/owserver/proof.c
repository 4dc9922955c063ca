/* SPDX-License-Identifier: MIT */
/* Which readings of an owserver prove by themselves that the chip has sent them. */
#include <string.h>

#include "hal/owfs/path.h"
#include "hal/owserver/proof.h"

/* owserver checks a checksum, or complements, of what these are asked for again and again. */
static const uint8_t checked[] = {0x10, 0x12, 0x1d, 0x20, 0x22, 0x26, 0x28, 0x29, 0x3a, 0x3b, 0x42};

static bool is(struct path_slice slice, const char *name)
{
	return slice.len == strlen(name) && memcmp(slice.text, name, slice.len) == 0;
}

bool proof_is_needed(const char *path)
{
	struct path split;

	if (path_split(path, strlen(path), &split) || !split.last.len || !split.property.len ||
	    is(split.property, "present"))
		return false;
	/* the slots of Read Power Supply, and nothing more */
	if (!split.has_rom || is(split.property, "power"))
		return true;
	return !memchr(checked, split.rom[0], sizeof(checked));
}
