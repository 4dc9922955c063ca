/* SPDX-License-Identifier: MIT */
/*
 * The terminal while a live table is on it, and the signals that end or change it. A process has
 * one.
 */
#pragma once

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
	KEY_SEARCH,
	KEY_SORT,
	KEY_BAD_FIRST,
	KEY_OTHER,
};

/* From now on SIGINT, SIGTERM and SIGHUP only make terminal_asked_to_end() true. */
void terminal_catch_signals(void);
bool terminal_asked_to_end(void);

/*
 * Take the terminal: another screen, no echo. terminal_close() gives it back, and so does exit().
 */
void terminal_open(void);
void terminal_close(void);

/*
 * After Ctrl-Z: give the terminal back, stop, and take it again; terminal_size() then says that the
 * size has changed. Call it in each round.
 */
void terminal_suspend_if_asked(void);
/* Lines and columns, 24 x 80 if unknown. True if the size changed since the last call. */
bool terminal_size(unsigned *lines, unsigned *columns);
/* Return the next key that was pressed, without waiting. */
enum terminal_key terminal_key(void);
/* The same while a text is typed: the next byte; 0: none. An escape sequence is one '\033'. */
char terminal_byte(void);
/* Write a whole picture; false: the terminal is gone. */
bool terminal_write(const char *text, size_t len);
