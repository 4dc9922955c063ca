/* SPDX-License-Identifier: MIT */
/* Which readings of an owserver prove by themselves that the chip has sent them. */
#include <string.h>

#include "hal/owfs/path.h"
#include "hal/owserver/proof.h"

/* owserver checks a checksum, or complements, of what these are asked for again and again. */
static const uint8_t checked[] = {0x10, 0x12, 0x1d, 0x20, 0x22, 0x26, 0x28, 0x29, 0x3a, 0x3b, 0x42};

/* ... but for these, of any family (0) or of one: pulled out, each was read as ones (3.2p4). */
static const struct {
	uint8_t family;
	const char *begin;
} unchecked[] = {{0, "power"},          {0, "errata/"},   {0x12, "memory"},
                 {0x12, "pages/page"},  {0x3b, "memory"}, {0x3b, "pages/page"},
                 {0x26, "S3-R1-A/gain"}};

static bool begins_with(struct path_slice slice, const char *begin)
{
	return slice.len >= strlen(begin) && memcmp(slice.text, begin, strlen(begin)) == 0;
}

bool proof_is_needed(const char *path)
{
	struct path split;

	if (path_split(path, strlen(path), &split) || !split.last.len || !split.property.len ||
	    (begins_with(split.property, "present") && split.property.len == strlen("present")))
		return false;
	if (!split.has_rom || !memchr(checked, split.rom[0], sizeof(checked)))
		return true;
	for (size_t i = 0; i < sizeof(unchecked) / sizeof(*unchecked); i++)
		if ((!unchecked[i].family || unchecked[i].family == split.rom[0]) &&
		    begins_with(split.property, unchecked[i].begin))
			return true;
	return false;
}
