/* SPDX-License-Identifier: MIT */
/* The lists of a family, found by a row of its table. */
#include "hal/chips/row.h"

const struct family *family_owner(const struct family *family, const struct property *property)
{
	uintptr_t row = (uintptr_t)property, first = (uintptr_t)family->properties;

	return row >= first && row - first < family->count * sizeof(*property) ? family
	                                                                       : &family_common;
}

const struct property_how *family_how(const struct family *family, const struct property *property)
{
	static const struct property_how none;

	return property->how ? &family_owner(family, property)->how[property->how] : &none;
}

const struct area *family_area(const struct txn *txn)
{
	return family_owner(txn->device->family, txn->property)->areas[txn->property->field.area];
}
