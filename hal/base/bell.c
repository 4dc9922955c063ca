/* SPDX-License-Identifier: MIT */
/* Bells are eventfds: one counter in the kernel. */
#include <errno.h>
#include <stdint.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "hal/base/bell.h"

int bell_open(void)
{
	int bell = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);

	return bell < 0 ? -errno : bell;
}

void bell_ring(int bell)
{
	const uint64_t one = 1;
	ssize_t n;

	/* it is full after 2^64 rings */
	do
		n = write(bell, &one, sizeof(one));
	while (n < 0 && errno == EINTR);
}

void bell_clear(int bell)
{
	uint64_t rings;
	ssize_t n;

	do
		n = read(bell, &rings, sizeof(rings));
	while (n < 0 && errno == EINTR);
}
