/* SPDX-License-Identifier: MIT */
/* What malloc keeps of what was freed. */
#include <stdlib.h> /* says whose malloc it is */
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "src/ground/service/heap.h"

/*
 * Each block of 16 KiB or more is a mapping of its own. A mapping is zero when it is new, so
 * calloc() does not clear it, and a page that is not used takes no memory. free() gives it back to
 * the system, so what reading a file, or a large answer, took does not stay. A limit that is set
 * here is fixed; without it malloc raises it with each larger block that is freed, up to 32 MiB.
 * The heap grows by what is needed and a page, not by the 128 KiB that malloc adds otherwise. All
 * threads share it: otherwise each has one of its own, which grows for hours where one thread frees
 * what another allocated.
 */
void heap_give_back(void)
{
#ifdef __GLIBC__
	mallopt(M_MMAP_THRESHOLD, 16 * 1024);
	mallopt(M_TOP_PAD, 4096);
	mallopt(M_ARENA_MAX, 1);
#endif
}
