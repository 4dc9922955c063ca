/* SPDX-License-Identifier: MIT */
/*
 * For the genuine programs on a pseudo-terminal, which is no line: it drops what was written and
 * not yet read when it is told to flush its output, where a line would have sent most of it; so the
 * input alone is flushed. And it passes no break: in its place a NUL is sent at half the slowest
 * speed, which holds a line low for as long.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <termios.h>
#include <unistd.h>

#define BREAK_US 20000

int tcflush(int fd, int queue)
{
	int (*next)(int, int);

	*(void **)&next = dlsym(RTLD_NEXT, "tcflush");
	return queue == TCOFLUSH ? 0 : next(fd, TCIFLUSH);
}

int tcsendbreak(int fd, int duration)
{
	struct termios set, slow;

	(void)duration;
	if (tcgetattr(fd, &set))
		return -1;
	slow = set;
	cfsetspeed(&slow, B4800);
	if (tcsetattr(fd, TCSANOW, &slow) || write(fd, "", 1) != 1)
		return -1;
	usleep(BREAK_US); /* pace */
	return tcsetattr(fd, TCSANOW, &set);
}
