/* SPDX-License-Identifier: MIT */
#ifndef SERVICE_STANDARD_H
#define SERVICE_STANDARD_H

/*
 * Open /dev/null on each of standard input, output and error that the caller has closed, so that no
 * file opened later gets its number and with it the messages meant for the user. Writes there still
 * fail. Called first in main(). Returns 0 or a negative errno.
 */
int standard_open(void);

#endif
