/* SPDX-License-Identifier: MIT */
/* The same verb on another machine. */
#pragma once

#include "src/tool/owsctl/ctl.h"

/*
 * Become ssh, which runs the verb with argv, its name first, on the HOST of ctl->instance, which is
 * NAME@HOST. Returns only where ssh cannot be started or HOST is none: the status, after printing
 * why.
 */
int remote_run(const struct ctl *ctl, int argc, char **argv);
