/* SPDX-License-Identifier: MIT */
/*
 * Corpses: processes that were killed while one of their threads cannot leave the kernel. A corpse
 * keeps its locks and sockets, and answers nobody.
 */
#pragma once

#include <stdbool.h>
#include <sys/types.h>

/* Is that process one? */
bool corpse_is(pid_t pid);
/* Is there one of this program, by its name? Looks at each process that this one sees. */
bool corpse_of_program(void);
