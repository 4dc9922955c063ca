/* SPDX-License-Identifier: MIT */
/* After a scan that found nothing: what the board lacks. */
#ifndef OWSCTL_SCAN_BOARD_H
#define OWSCTL_SCAN_BOARD_H

/*
 * After a scan that found nothing: print on stderr which board this is and what is missing there.
 * For a target that is not this machine's hardware, prints nothing.
 */
void scan_board(const char *target);

#endif
