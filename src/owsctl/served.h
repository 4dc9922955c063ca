/* SPDX-License-Identifier: MIT */
/* The owserver protocol as an instance of owsd serves it: where, and what is behind it. */
#ifndef OWSCTL_SERVED_H
#define OWSCTL_SERVED_H

#include <stddef.h>

#include "src/owsctl/ctl.h"

struct served {
	bool runs;          /* there is an owsd of that name, and it lives */
	char target[160];   /* what reaches it; "" where it serves none */
	char targets[1024]; /* its own, as in TargetName */
	bool cut;           /* not all of them, or not whole */
};

/* CTL_DONE, or CTL_FAILED after having said why: the instance was asked for and is not there. */
int served_find(const struct ctl *ctl, struct served *served);

#endif
