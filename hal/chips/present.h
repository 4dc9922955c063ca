/* SPDX-License-Identifier: MIT */
/* The present time, for the clocks of chips. */
#ifndef HAL_CHIPS_PRESENT_H
#define HAL_CHIPS_PRESENT_H

/*
 * Seconds of 1970 by the host's clock. -EAGAIN: it says a time before this program was written, as
 * that of a board without a battery does until it has heard of the time: *seconds stays as it is.
 * Never blocks.
 */
int present_time(double *seconds);

#endif
