/* SPDX-License-Identifier: MIT */
/* Properties without a device: their functions use no wire. */
#ifndef HAL_NATIVE_VIRTUAL_H
#define HAL_NATIVE_VIRTUAL_H

#include "hal/chips/family.h"

int virtual_put(struct txn *txn, const char *text);
int virtual_zero(struct txn *txn);
/* A count modulo 2^32, as the text of an unsigned has it. */
int virtual_count(struct txn *txn, uint64_t count);

/* clang-format off */
#define VIRTUAL(text, kind, life_, access_, what, reads, writes)                          \
	{.name = (text), .type = (kind), .life = (life_), .access = (access_),              \
	 .offline = true, .arg = (what), .read = (reads), .write = (writes)}
/* clang-format on */
#define VIRTUAL_NUMBER(text, reads, what) \
	VIRTUAL(text, PROPERTY_UNSIGNED, LIFE_VOLATILE, ACCESS_READ, what, reads, NULL)
/* clang-format off */
#define VIRTUAL_TEXT(text, bytes, reads)                                                  \
	{.name = (text), .type = PROPERTY_ASCII, .life = LIFE_STATIC, .access = ACCESS_READ, \
	 .offline = true, .size = (bytes), .read = (reads)}
/* clang-format on */

#endif
