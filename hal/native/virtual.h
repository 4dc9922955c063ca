/* SPDX-License-Identifier: MIT */
/* Properties without a device: their functions use no wire. */
#pragma once

#include "hal/chips/family.h"

/* arg is the value. */
int virtual_arg(struct txn *txn);
/*
 * arg is where a count stands (uint64_t) in struct native, or the first one of an array. Its value
 * modulo 2^32, as the text of an unsigned has it.
 */
int virtual_count(struct txn *txn);

/* NOLINTBEGIN(bugprone-macro-parentheses): a string in parentheses fills no array */
/* clang-format off */
#define VIRTUAL(text, kind, life_, access_, what, how_)                                    \
	{.name = text, .type = (kind), .life = (life_), .access = (access_),                \
	 .offline = true, .arg = (what), .how = (how_)}
/* clang-format on */
#define VIRTUAL_NUMBER(text, how_, what) \
	VIRTUAL(text, PROPERTY_UNSIGNED, LIFE_VOLATILE, ACCESS_READ, what, how_)
/* clang-format off */
#define VIRTUAL_TEXT(text, bytes, how_)                                                   \
	{.name = text, .type = PROPERTY_ASCII, .life = LIFE_STATIC, .access = ACCESS_READ,  \
	 .offline = true, .size = (bytes), .how = (how_)}
/* clang-format on */
/* NOLINTEND(bugprone-macro-parentheses) */
