/* SPDX-License-Identifier: MIT */
/* The answer of the property "identity" (identity.h). */
#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/identity.h"

int identity_put(struct txn *txn, const char *text)
{
	size_t len = strlen(text);

	if (len > txn->room)
		return -EMSGSIZE;
	memcpy(txn->data, text, len);
	txn->len = len;
	return 0;
}

int identity_read_type(struct txn *txn)
{
	return identity_put(txn, family_type(txn->device));
}
