/* SPDX-License-Identifier: MIT */
/* The time of the host, for the clocks of chips. */
#pragma once

/*
 * Seconds since 1970 by the host's clock. -EAGAIN: it says a time before this program was written,
 * as that of a board without a battery does until it has heard of the time: *seconds stays as it
 * is. Never blocks.
 */
int host_clock(double *seconds);
