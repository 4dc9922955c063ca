/* SPDX-License-Identifier: MIT */
/* Families found by code, and their properties by name or in order. */
#pragma once

#include "hal/chips/family.h"

/* Never NULL: families that are not known have the common properties. */
const struct family *family_of(uint8_t code);
/* The families of this build, in the order of their codes; NULL behind the last. */
const struct family *family_nth(unsigned n);
/* By its name without extension (len bytes); NULL: no such property of this device. */
const struct property *family_property(const struct family *family, const struct device *device,
                                       const char *name, size_t len);
/*
 * All properties by their names, the common ones of devices merged in: the first behind prev (NULL:
 * the first of all). NULL: that was the last. Without a device, also those that only some chips
 * of the family have.
 */
const struct property *family_next(const struct family *family, const struct device *device,
                                   const struct property *prev);
