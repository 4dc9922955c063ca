/* SPDX-License-Identifier: MIT */
/* What a row of a family's table names by a number: found in the lists of the family. */
#pragma once

#include "hal/chips/family.h"

/* The family whose row it is: this one or family_common. */
const struct family *family_owner(const struct family *family, const struct property *property);
/* What no field can say of the property; never NULL. */
const struct property_how *family_how(const struct family *family, const struct property *property);
/* The area of the field of txn->property. */
const struct area *family_area(const struct txn *txn);
