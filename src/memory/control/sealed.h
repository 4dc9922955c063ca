/* SPDX-License-Identifier: MIT */
/* The memory of a controller: made by owsd, sealed, mapped by both. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/*
 * Zeroed memory of that size, all of it allocated, mapped, and sealed against shrinking, growing
 * and more seals. Returns the descriptor for the controller, or a negative errno; own is one that
 * stays here.
 */
int sealed_make(size_t size, char **base, int *own);
void sealed_unmap(char *base, size_t size);
/*
 * Has it no pages any more? owsd itself asks for nothing more of a memory that a controller has
 * had: one that writes to the file out of memory that never comes holds its inode's lock for ever,
 * and a process that empties the file waits for it, even against SIGKILL.
 */
bool sealed_is_empty(int own);
