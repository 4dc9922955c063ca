/* SPDX-License-Identifier: MIT */
#ifndef OWSD_STANDARD_H
#define OWSD_STANDARD_H

/*
 * Standard input, output and error that the caller has closed are taken, so that no file opened
 * later gets their number and with it what is meant for people. Writes there fail as they did.
 * First in main(); 0 or a negative errno.
 */
int standard_open(void);

#endif
