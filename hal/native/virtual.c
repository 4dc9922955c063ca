/* SPDX-License-Identifier: MIT */
/* What the functions of properties without a device have in common. */
#include <errno.h>
#include <string.h>

#include "hal/native/virtual.h"

int virtual_put(struct txn *txn, const char *text)
{
	size_t len = strlen(text);

	if (len > txn->room)
		return -EMSGSIZE;
	memcpy(txn->data, text, len);
	txn->len = len;
	return 0;
}

int virtual_zero(struct txn *txn)
{
	txn->number[0] = 0;
	return 0;
}

int virtual_count(struct txn *txn, uint64_t count)
{
	txn->number[0] = (double)(uint32_t)count;
	return 0;
}
