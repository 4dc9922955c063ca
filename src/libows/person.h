/* SPDX-License-Identifier: MIT */
/* For whom a program commands: the names of persons in the controller's memory. */
#ifndef LIBOWS_PERSON_H
#define LIBOWS_PERSON_H

struct ows;

/* Enter the handle's person into its memory. Returns 0, or -EBUSY: all places are in use. */
int person_enter(struct ows *h);

#endif
