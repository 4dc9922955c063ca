/* SPDX-License-Identifier: MIT */
/* What follows from the description of a property; functions that families have in common. */
#include <errno.h>
#include <string.h>

#include "hal/chips/property.h"

unsigned property_size(const struct property *property)
{
	switch ((enum property_type)property->type) {
	case PROPERTY_DIRECTORY:
	case PROPERTY_ASCII:
	case PROPERTY_BINARY:
		return property->size;
	case PROPERTY_DATE:
		return 24;
	case PROPERTY_FLOAT:
	case PROPERTY_TEMPGAP:
	case PROPERTY_INTEGER:
	case PROPERTY_PRESSURE:
	case PROPERTY_TEMPERATURE:
	case PROPERTY_UNSIGNED:
		return 12;
	case PROPERTY_ALIAS:
		return DEVICE_ALIAS_MAX;
	case PROPERTY_YESNO:
	case PROPERTY_BITS:
		return 1;
	}
	return 0;
}

bool property_has_entries(const struct property *property)
{
	return property->type == PROPERTY_DIRECTORY && !property->size;
}

int property_refuse(struct txn *txn)
{
	(void)txn;
	return -EOPNOTSUPP;
}

int property_text(struct txn *txn, const char *text)
{
	size_t len = strlen(text);

	if (len > txn->room)
		return -EMSGSIZE;
	memcpy(txn->data, text, len);
	txn->len = len;
	return 0;
}
