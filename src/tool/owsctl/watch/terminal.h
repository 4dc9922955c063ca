/* SPDX-License-Identifier: MIT */
/* The terminal while a live table is on it, and the signals that end it. A process has one. */
#pragma once

#include <stdbool.h>

/* From now on SIGINT, SIGTERM and SIGHUP only make terminal_asked_to_end() true. */
void terminal_catch_signals(void);
bool terminal_asked_to_end(void);

/*
 * Take the terminal: another screen, no echo. terminal_close() gives it back, and so does exit().
 */
void terminal_open(void);
void terminal_close(void);

/* Lines and columns, 24 x 80 if unknown. True if the size changed since the last call. */
bool terminal_size(unsigned *lines, unsigned *columns);
/*
 * Return the next byte that was typed, without waiting; 0: none. Of an arrow or page key it is the
 * letter that less(1) has for it, with TERMINAL_ESCAPED; so is Esc itself.
 */
#define TERMINAL_ESCAPED 0x100
int terminal_key(void);
