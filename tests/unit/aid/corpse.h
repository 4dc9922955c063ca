/* SPDX-License-Identifier: MIT */
/* A process whose leader has gone while a thread of it lives on, as one that the kernel holds. */
#pragma once

#include <sys/types.h>

struct corpse {
	pid_t pid;
	int hold;
};

/*
 * Make one, in which first was called, if there is one. It keeps a copy of each descriptor of this
 * process. Before the first thread: a fork has but one.
 */
void corpse_make(struct corpse *corpse, void (*first)(void));
/* The kernel lets the thread go, and the process ends. */
void corpse_end(struct corpse *corpse);
/* This process gets a name that no other has: by its name a program knows corpses of its own. */
void corpse_own_name(void);
