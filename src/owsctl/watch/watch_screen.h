/* SPDX-License-Identifier: MIT */
/* The live table of `owsctl watch`. */
#ifndef OWSCTL_WATCH_SCREEN_H
#define OWSCTL_WATCH_SCREEN_H

#include "src/owsctl/watch/watch_sleep.h"

/* Show the table on the terminal until the user ends it. Returns the exit status. */
int watch_screen(struct watch *watch);

#endif
