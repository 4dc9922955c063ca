/* SPDX-License-Identifier: MIT */
/* The live table of `owsctl watch`. */
#ifndef OWSCTL_WATCH_SCREEN_H
#define OWSCTL_WATCH_SCREEN_H

#include "src/owsctl/watch_sleep.h"

/* The table on the terminal until the end; exit status. */
int watch_screen(struct watch *watch);

#endif
