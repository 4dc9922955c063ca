/* SPDX-License-Identifier: MIT */
/* Shelved alarms that outlive a reload, a restart and a kill of owsd. */
#pragma once

#include <stddef.h>

#include "src/memory/shm/image.h"

/*
 * Enter what is shelved in the image before, of size bytes, for the records of the same names; a
 * name that is gone is left out. The image before may be of another owsd, and cut off anywhere.
 */
void shelves_carry(struct image *image, const void *before, size_t size);
