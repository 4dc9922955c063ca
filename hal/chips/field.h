/* SPDX-License-Identifier: MIT */
/* Properties that are fields of an area: read and written as the bits of a chip. */
#pragma once

#include "hal/chips/family.h"

/*
 * Of a property with .field: txn->property's element txn->element, or all. Of binary that is longer
 * than FIELD_CHUNK bytes it reads a chunk, from txn->at on: one that failed is read again alone,
 * and requests for other chips, and for this one, come between. Elements of arrays have no more.
 */
#define FIELD_CHUNK 512
int field_read(struct txn *txn);
int field_write(struct txn *txn);

/* What reads it, and what writes it: the property's function, or the field's; NULL: nothing. */
property_function *property_reader(const struct family *family, const struct property *property);
property_function *property_writer(const struct family *family, const struct property *property);

/* The family whose row it is: this one or family_common. */
const struct family *family_owner(const struct family *family, const struct property *property);
/* What no field can say of the property; never NULL. */
const struct property_how *family_how(const struct family *family, const struct property *property);
/* The area of the field of txn->property. */
const struct area *family_area(const struct txn *txn);
