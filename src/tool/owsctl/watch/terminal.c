/* SPDX-License-Identifier: MIT */
/* The terminal of the live table: raw mode, its size, its keys, and the signals that end it. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "src/tool/owsctl/watch/terminal.h"

static volatile sig_atomic_t end_asked;
static struct {
	bool open, raw;
	struct termios before;
	unsigned lines, columns;
} terminal;

static void on_end(int number)
{
	(void)number;
	end_asked = 1;
}

void terminal_catch_signals(void)
{
	struct sigaction action = {.sa_handler = on_end};

	sigemptyset(&action.sa_mask);
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
	sigaction(SIGHUP, &action, NULL);
}

bool terminal_asked_to_end(void)
{
	return end_asked;
}

void terminal_open(void)
{
	struct termios raw;

	atexit(terminal_close);
	terminal.open = true;
	fputs("\033[?1049h\033[?25l\033[?7l", stdout);
	/* in the background tcsetattr() would stop the process */
	if (tcgetpgrp(STDIN_FILENO) != getpgrp() || tcgetattr(STDIN_FILENO, &terminal.before) != 0)
		return;
	raw = terminal.before;
	raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
	raw.c_cc[VMIN] = 0;
	raw.c_cc[VTIME] = 0;
	/* a stopped process would leave the shell this screen */
	raw.c_cc[VSUSP] = _POSIX_VDISABLE;
	terminal.raw = tcsetattr(STDIN_FILENO, TCSADRAIN, &raw) == 0;
}

void terminal_close(void)
{
	if (!terminal.open)
		return;
	terminal.open = false;
	/*
	 * Empty the screen first: a terminal that was resized meanwhile may keep lines of the
	 * picture.
	 */
	fputs("\033[H\033[J\033[?7h\033[?25h\033[?1049l", stdout);
	fflush(stdout);
	if (terminal.raw)
		tcsetattr(STDIN_FILENO, TCSADRAIN, &terminal.before);
}

bool terminal_size(unsigned *lines, unsigned *columns)
{
	struct winsize size = {0};
	bool changed;

	if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || !size.ws_row || !size.ws_col) {
		size.ws_row = 24;
		size.ws_col = 80;
	}
	changed = size.ws_row != terminal.lines || size.ws_col != terminal.columns;
	*lines = terminal.lines = size.ws_row;
	*columns = terminal.columns = size.ws_col;
	return changed;
}

static int next_byte(void)
{
	unsigned char byte;

	return terminal.raw && read(STDIN_FILENO, &byte, 1) == 1 ? byte : 0;
}

int terminal_key(void)
{
	/* what ends the sequence of a key, or is the number in it; and its letter */
	static const char ends[] = "ABHF1456", letters[] = "kjgGgGb ";
	int byte = next_byte(), number = 0;
	const char *end;

	if (byte != '\033')
		return byte;
	byte = next_byte();
	if (byte != '[' && byte != 'O')
		return TERMINAL_ESCAPED | '\033';
	while ((byte = next_byte()) && byte < '@')
		number = byte;
	end = byte ? strchr(ends, byte == '~' ? number : byte) : NULL;
	return TERMINAL_ESCAPED | (end && *end ? letters[end - ends] : '\0');
}
