/* SPDX-License-Identifier: MIT */
/* A tag: a number by which a change of a text shows. */
#ifndef CONFIG_TAG_H
#define CONFIG_TAG_H

#include <stddef.h>
#include <stdint.h>

/* FNV-1a of 64 bits: it shows a change, and is no secret. */
#define TAG_BEGIN UINT64_C(0xcbf29ce484222325)
static inline uint64_t tag_add(uint64_t tag, unsigned char byte)
{
	return (tag ^ byte) * UINT64_C(0x100000001b3);
}

#define TAG_TEXT 17 /* 16 hexadecimal digits, and NUL */
void tag_print(const char *bytes, size_t len, char text[TAG_TEXT]);

#endif
