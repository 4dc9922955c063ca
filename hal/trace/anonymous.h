/* SPDX-License-Identifier: MIT */
/* Other ids in place of those of a recording. */
#pragma once

#include <stdint.h>

#define TRACE_MASK 4
/*
 * Replace the ids in the text of a recording: other serial numbers of the same families, the same
 * one everywhere, with its checksum. mask: random bytes. An id is changed by the same bits as
 * all others, but for those where two of them part: so searches find them in the same order. Its
 * two last bytes stay, which tell the version of a DS1921, or a clone.
 */
void trace_anonymous(char *text, const uint8_t mask[TRACE_MASK]);
