/* SPDX-License-Identifier: MIT */
/* Nothing was found: what the board lacks for it. */
#ifndef OWSCTL_SCAN_BOARD_H
#define OWSCTL_SCAN_BOARD_H

/*
 * Nothing was found: say on stderr which board this is and what is missing there. Of a target that
 * is not this machine's hardware, nothing is said.
 */
void scan_board(const char *target);

#endif
