/* SPDX-License-Identifier: MIT */
/*
 * The terminal of the live views: raw mode, its size, its keys, and the signals that end or stop
 * it.
 */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "src/tool/owsctl/watch/terminal.h"

static volatile sig_atomic_t end_asked, stop_asked;
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

static void on_stop(int number)
{
	(void)number;
	stop_asked = 1;
}

static void on_size(int number)
{
	(void)number; /* the signal only ends the sleep */
}

static void on_signal(int number, void (*handler)(int))
{
	struct sigaction action = {.sa_handler = handler};

	sigemptyset(&action.sa_mask);
	sigaction(number, &action, NULL);
}

void terminal_catch_signals(void)
{
	on_signal(SIGINT, on_end);
	on_signal(SIGTERM, on_end);
	on_signal(SIGHUP, on_end);
}

bool terminal_asked_to_end(void)
{
	return end_asked;
}

static void set_raw(void)
{
	struct termios raw;

	/* in the background tcsetattr() would stop the process */
	if (tcgetpgrp(STDIN_FILENO) != getpgrp() || tcgetattr(STDIN_FILENO, &terminal.before) != 0)
		return;
	raw = terminal.before;
	raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
	raw.c_cc[VMIN] = 0;
	raw.c_cc[VTIME] = 0;
	terminal.raw = tcsetattr(STDIN_FILENO, TCSADRAIN, &raw) == 0;
}

void terminal_open(void)
{
	static const char enter[] = "\033[?1049h\033[?25l\033[?7l";
	static bool registered;

	if (!registered) {
		on_signal(SIGWINCH, on_size);
		atexit(terminal_close);
		registered = true;
	}
	on_signal(SIGTSTP, on_stop);
	set_raw();
	terminal.open = true;
	terminal.lines = 0;
	terminal_write(enter, sizeof(enter) - 1);
}

void terminal_close(void)
{
	/*
	 * Empty the screen first: a terminal that was resized meanwhile may keep lines of the
	 * picture.
	 */
	static const char leave[] = "\033[H\033[J\033[?7h\033[?25h\033[?1049l";

	if (!terminal.open)
		return;
	terminal.open = false;
	terminal_write(leave, sizeof(leave) - 1);
	if (terminal.raw)
		tcsetattr(STDIN_FILENO, TCSADRAIN, &terminal.before);
	terminal.raw = false;
}

void terminal_suspend_if_asked(void)
{
	if (!stop_asked)
		return;
	stop_asked = 0;
	terminal_close();
	on_signal(SIGTSTP, SIG_DFL);
	raise(SIGTSTP);
	terminal_open();
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

static const struct {
	const char *bytes;
	enum terminal_key key;
} keys[] = {
	{"\033[A", KEY_UP},    {"\033OA", KEY_UP},       {"\033[B", KEY_DOWN},
	{"\033OB", KEY_DOWN},  {"\033[5~", KEY_PAGE_UP}, {"\033[6~", KEY_PAGE_DOWN},
	{"\033[H", KEY_FIRST}, {"\033OH", KEY_FIRST},    {"\033[1~", KEY_FIRST},
	{"\033[F", KEY_LAST},  {"\033OF", KEY_LAST},     {"\033[4~", KEY_LAST},
	{"k", KEY_UP},         {"j", KEY_DOWN},          {"b", KEY_PAGE_UP},
	{" ", KEY_PAGE_DOWN},  {"g", KEY_FIRST},         {"G", KEY_LAST},
	{"q", KEY_END},        {"Q", KEY_END},           {"\004", KEY_END},
	{"/", KEY_SEARCH},     {"s", KEY_SORT},          {"!", KEY_BAD_FIRST},
};

static struct {
	char bytes[32];
	size_t len;
} typed;

/* Take what was typed since. False: the terminal is gone. */
static bool take_typed(void)
{
	struct pollfd in = {.fd = STDIN_FILENO, .events = POLLIN};
	ssize_t n;

	if (typed.len == sizeof(typed.bytes) || poll(&in, 1, 0) <= 0)
		return true;
	n = read(STDIN_FILENO, typed.bytes + typed.len, sizeof(typed.bytes) - typed.len);
	if (n > 0)
		typed.len += (size_t)n;
	return n > 0 || !(in.revents & POLLHUP);
}

static void drop_typed(size_t size)
{
	typed.len -= size;
	memmove(typed.bytes, typed.bytes + size, typed.len);
}

enum terminal_key terminal_key(void)
{
	if (!terminal.raw)
		return KEY_NONE;
	if (!take_typed())
		return KEY_END;
	if (typed.len == 0)
		return KEY_NONE;
	for (size_t i = 0; i < sizeof(keys) / sizeof(keys[0]); i++) {
		size_t size = strlen(keys[i].bytes);

		if (typed.len >= size && memcmp(typed.bytes, keys[i].bytes, size) == 0) {
			drop_typed(size);
			return keys[i].key;
		}
	}
	drop_typed(1);
	return KEY_OTHER;
}

char terminal_byte(void)
{
	char byte;

	if (!terminal.raw || !take_typed() || typed.len == 0)
		return '\0';
	byte = typed.bytes[0];
	drop_typed(byte == '\033' ? typed.len : 1);
	return byte;
}

bool terminal_write(const char *text, size_t len)
{
	while (len > 0) {
		ssize_t n = write(STDOUT_FILENO, text, len);

		if (n > 0) {
			text += n;
			len -= (size_t)n;
		} else if (n == 0 || (errno != EINTR && errno != EAGAIN)) {
			return false;
		} else if (errno == EAGAIN) {
			struct pollfd out = {.fd = STDOUT_FILENO, .events = POLLOUT};

			if (poll(&out, 1, 1000) <= 0)
				return false;
		}
	}
	return true;
}
