/* SPDX-License-Identifier: MIT */
/* What the functions of properties without a device have in common. */
#include <string.h>

#include "hal/native/virtual.h"

int virtual_arg(struct txn *txn)
{
	txn->number[0] = txn->property->arg;
	return 0;
}

int virtual_count(struct txn *txn)
{
	size_t at = (size_t)txn->property->arg + (size_t)txn->element * sizeof(uint64_t);
	uint64_t count;

	memcpy(&count, (const char *)txn->native + at, sizeof(count));
	txn->number[0] = (double)(uint32_t)count;
	return 0;
}
