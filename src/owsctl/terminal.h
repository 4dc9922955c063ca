/* SPDX-License-Identifier: MIT */
/*
 * The terminal while a live table is on it, and the signals that end or change it. One terminal for
 * a process.
 */
#ifndef OWSCTL_TERMINAL_H
#define OWSCTL_TERMINAL_H

#include <stdbool.h>
#include <stddef.h>

enum terminal_key {
	KEY_NONE,
	KEY_END, /* q, Ctrl-D */
	KEY_UP,
	KEY_DOWN,
	KEY_PAGE_UP,
	KEY_PAGE_DOWN,
	KEY_FIRST,
	KEY_LAST,
	KEY_OTHER,
};

/* From now on SIGINT, SIGTERM and SIGHUP only make terminal_asked_to_end() true. */
void terminal_catch_signals(void);
bool terminal_asked_to_end(void);

/* Take the terminal: another screen, no echo. Given back by terminal_close(), and at exit. */
void terminal_open(void);
void terminal_close(void);

/* Stopped by Ctrl-Z: give the terminal back, stop, take it again. Call it in each round. */
void terminal_suspend_if_asked(void);
/* Lines and columns, 24 x 80 if unknown. True if the size changed since the last call. */
bool terminal_size(unsigned *lines, unsigned *columns);
/* Next key that was pressed; does not wait. */
enum terminal_key terminal_key(void);
/* Write a whole picture; false when the terminal is gone. */
bool terminal_write(const char *text, size_t len);

#endif
