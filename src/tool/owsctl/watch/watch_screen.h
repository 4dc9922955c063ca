/* SPDX-License-Identifier: MIT */
/* The live table of `owsctl watch`. */
#pragma once

#include "src/tool/owsctl/watch/watch_sleep.h"

/* Show the table on the terminal until the user ends it. */
void watch_screen(struct watch *watch);
