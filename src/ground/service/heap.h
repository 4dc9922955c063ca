/* SPDX-License-Identifier: MIT */
/* How malloc of a program that runs for months takes memory and gives it back. */
#pragma once

/* Call it first in main(), before a thread or an allocation. With another libc it does nothing. */
void heap_give_back(void);
