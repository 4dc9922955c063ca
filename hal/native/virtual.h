/* SPDX-License-Identifier: MIT */
/* Properties without a device: their functions use no wire. */
#pragma once

#include "hal/chips/family.h"

int virtual_put(struct txn *txn, const char *text);
int virtual_zero(struct txn *txn);
/* A count modulo 2^32, as the text of an unsigned has it. */
int virtual_count(struct txn *txn, uint64_t count);

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
