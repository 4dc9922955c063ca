/* SPDX-License-Identifier: MIT */
/* Shelved alarms that outlive a reload, a restart and a kill of owsd. */
#pragma once

#include <stddef.h>

#include "src/memory/shm/image.h"

/*
 * Enter what is shelved in the image before, of size bytes. records: as of image_carry_journals();
 * NULL: a record is that of the same identity. What has none there goes to the record of the same
 * name that is no other's, and is left out if there is none. The image before may be of another
 * owsd, and cut off anywhere.
 */
void shelves_carry(struct image *image, const void *before, size_t size, const uint32_t *records);
