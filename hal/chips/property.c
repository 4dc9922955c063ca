/* SPDX-License-Identifier: MIT */
/* What follows from the description of a property; functions that families have in common. */
#include <errno.h>
#include <string.h>

#include "hal/chips/property.h"

static const struct {
	uint8_t form;
	uint16_t size; /* 0: that of the property */
} types[] = {
	[PROPERTY_DIRECTORY] = {FORM_NONE, 0},
	[PROPERTY_ASCII] = {FORM_TEXT, 0},
	[PROPERTY_BINARY] = {FORM_TEXT, 0},
	[PROPERTY_ALIAS] = {FORM_TEXT, DEVICE_ALIAS_MAX},
	[PROPERTY_DATE] = {FORM_DATE, 24},
	[PROPERTY_YESNO] = {FORM_YESNO, 1},
	[PROPERTY_BITS] = {FORM_YESNO, 1},
	[PROPERTY_INTEGER] = {FORM_WHOLE, 12},
	[PROPERTY_UNSIGNED] = {FORM_WHOLE, 12},
	[PROPERTY_FLOAT] = {FORM_DECIMAL, 12},
	[PROPERTY_TEMPGAP] = {FORM_DECIMAL, 12},
	[PROPERTY_PRESSURE] = {FORM_DECIMAL, 12},
	[PROPERTY_TEMPERATURE] = {FORM_DECIMAL, 12},
};

enum property_form property_form(uint8_t type)
{
	return (enum property_form)types[type].form;
}

unsigned property_size(const struct property *property)
{
	unsigned size = types[property->type].size;

	return size ? size : property->size;
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
