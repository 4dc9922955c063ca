/* SPDX-License-Identifier: MIT */
/* A number by which a change of a text shows: FNV-1a of 64 bits. It is no secret. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define HASH_BEGIN UINT64_C(0xcbf29ce484222325)

/* From HASH_BEGIN, or from the hash of the bytes before these. */
static inline uint64_t hash_text(uint64_t hash, const char *text, size_t len)
{
	for (size_t i = 0; i < len; i++)
		hash = (hash ^ (uint8_t)text[i]) * UINT64_C(0x100000001b3);
	return hash;
}
