/* SPDX-License-Identifier: MIT */
/* What a program that runs for months keeps of memory: of its own code, and by malloc. */
#pragma once

/*
 * Give back the pages of files that the program has mapped and cannot write, its code and constants
 * and those of its libraries: most of them only the start has used. What is used again comes back
 * from the page cache, and from the file where the system needed the memory. A mapping stays of
 * which one page is no more that of the file (relocated, a breakpoint, a probe); all stay where
 * memory is locked, or /proc cannot be read. Blocks for a millisecond: call it once, when the start
 * is over.
 */
void resident_drop_start(void);

/*
 * malloc gives back what was freed. Call it first in main(), before a thread or an allocation. With
 * another libc it does nothing.
 */
void heap_give_back(void);
