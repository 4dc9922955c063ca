/* SPDX-License-Identifier: MIT */
/* Waits for a thread of this program that is going to wait in the kernel. */
#pragma once

/*
 * Return when the thread of this name sleeps; NULL: the main one. Also after 60 s in which it did
 * not: what is done then must be right before the thread sleeps as well, and is tested less.
 */
void until_asleep(const char *name);
