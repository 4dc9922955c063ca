/* SPDX-License-Identifier: MIT */
/*
 * A program that waits for owsd in a poll() of its own, by ows_fd() alone and without a timeout, as
 * libows(3) allows. It prints a dot for each look that has found changes.
 */
#include <errno.h>
#include <poll.h>
#include <stdio.h>

#include "src/public/ows.h"

int main(int argc, char **argv)
{
	struct ows_cursor cursor = {0};
	struct ows *h;
	int signals[16];

	if (argc != 2 || ows_open(argv[1], OWS_READ, &h))
		return 1;
	for (;;) {
		struct pollfd news = {.fd = ows_fd(h), .events = POLLIN};
		int n = ows_changes(h, &cursor, signals, 16, 0);

		if (news.fd < 0)
			return 2;
		if (n == -ESTALE && ows_reopen(h) == 0)
			continue;
		if (n > 0 || n == -EOVERFLOW) {
			printf(".\n");
			fflush(stdout);
		} else {
			poll(&news, 1, -1);
		}
	}
}
