/* SPDX-License-Identifier: MIT */
/* The target that a verb of owsctl opens: that of -t, or the protocol that an instance serves. */
#pragma once

#include "src/ground/signal/error.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/scan/target.h"

/*
 * The owserver protocol as an instance of owsd serves it: its address, and the targets it serves.
 */
struct served {
	bool runs;          /* an owsd of that name exists and is alive */
	char target[160];   /* the target that reaches the protocol; "": owsd does not serve it */
	bool own;           /* that is NAME.sock, which takes no writes */
	char targets[1024]; /* the targets of owsd, as in TargetName */
	bool cut;           /* targets is cut */
};

#define OPEN_DEFAULT_TARGET "localhost:4304"
#define OPEN_TIMEOUT_NS (20 * NS_PER_S)

/*
 * Open ctl->target, or without one the served target of the instance, which is in *served.
 * CTL_DONE, or the status after printing why.
 */
int open_target(const struct ctl *ctl, int64_t timeout_ns, struct target *target,
                struct served *served);

/* " (asked owsd OWS)" for the end of an error; "" if the user named the target. */
const char *open_asked(const struct ctl *ctl, const struct target *target,
                       const struct served *served);

/* The option -w of all verbs that open a target; as ctl_option(). */
int target_option(struct ctl *ctl, int argc, char **argv, const char *options, int64_t *timeout_ns);
