/* SPDX-License-Identifier: MIT */
/* Streams that a process gets from the one that starts it. */
#pragma once

#include <stdbool.h>

/*
 * Open /dev/null on each of standard input, output and error that the caller has closed, so that no
 * file opened later gets its number and with it the messages meant for the user. Writes there still
 * fail, and so does one beyond the limit of a file's size, which would end the program otherwise.
 * Called first in main(). Returns 0 or a negative errno.
 */
int standard_open(void);

/* Does stderr go to the journal of systemd, which reads levels from "<4>" prefixes? */
bool journal_is_stderr(void);
