/* SPDX-License-Identifier: MIT */
/* UTF-8 decoded, a character at a time. */
#include "src/ground/signal/utf8.h"

int32_t utf8_next(const char **text, size_t *len)
{
	static const int32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
	const unsigned char *at = (const unsigned char *)*text;
	size_t size = at[0] < 0x80   ? 1
	              : at[0] < 0xc2 ? 0
	              : at[0] < 0xe0 ? 2
	              : at[0] < 0xf0 ? 3
	              : at[0] < 0xf5 ? 4
	                             : 0;
	int32_t c = size < 2 ? at[0] : at[0] & (0x7f >> size);
	bool bad = size == 0 || size > *len;

	for (size_t i = 1; !bad && i < size; i++) {
		bad = (at[i] & 0xc0) != 0x80;
		c = (int32_t)((uint32_t)c << 6 | (at[i] & 0x3f));
	}
	if (bad || (size > 1 && c < least[size]) || (c >= 0xd800 && c < 0xe000) || c > 0x10ffff) {
		size = 1;
		c = -1;
	}
	*text += size;
	*len -= size;
	return c;
}

bool utf8_disturbs(int32_t code)
{
	return code < 0x20 || (code >= 0x7f && code < 0xa0) || (code >= 0x2028 && code <= 0x202e) ||
	       (code >= 0x2066 && code <= 0x2069);
}
