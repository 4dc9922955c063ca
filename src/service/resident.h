/* SPDX-License-Identifier: MIT */
/* What a program keeps mapped of its own code. */
#ifndef SERVICE_RESIDENT_H
#define SERVICE_RESIDENT_H

/*
 * Give back the pages of code and constants of the program and its libraries: most of them only the
 * start has used. What is used again comes back from the page cache, and from the file where the
 * system needed the memory. Does nothing where memory is locked, or a debugger has set breakpoints
 * into these pages. Blocks for some hundred microseconds: call it once, when the start is over.
 */
void resident_drop_start(void);

#endif
