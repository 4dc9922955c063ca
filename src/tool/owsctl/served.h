/* SPDX-License-Identifier: MIT */
/*
 * The owserver protocol as an instance of owsd serves it: its address, and the targets it serves.
 */
#pragma once

#include "src/tool/owsctl/ctl.h"

struct served {
	bool runs;          /* an owsd of that name exists and is alive */
	char target[160];   /* the target that reaches the protocol; "": owsd does not serve it */
	bool own;           /* that is NAME.sock, which takes no writes */
	char targets[1024]; /* the targets of owsd, as in TargetName */
	bool cut;           /* targets is cut */
};

/*
 * CTL_DONE, or CTL_FAILED after printing why: the user named an instance that is not there, or that
 * does not serve what the verb needs.
 */
int served_find(const struct ctl *ctl, struct served *served);
