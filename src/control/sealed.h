/* SPDX-License-Identifier: MIT */
/* The memory of a giver: made by owsd, sealed, mapped by both. */
#ifndef CONTROL_SEALED_H
#define CONTROL_SEALED_H

#include <stddef.h>

/*
 * Zeroed memory of that size, all of it allocated, mapped, and sealed against shrinking, growing
 * and more seals. Returns its descriptor, or a negative errno.
 */
int sealed_make(size_t size, char **base);
/* Give the pages back to the machine, also while another process maps them, and unmap. */
void sealed_free(char *base, size_t size);

#endif
