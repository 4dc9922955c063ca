/* SPDX-License-Identifier: MIT */
/* The kernel's boot id, as a number. */
#include "src/history/boot.h"

#include <fcntl.h>
#include <unistd.h>

int64_t history_boot_present(void)
{
	uint64_t hash = 0xcbf29ce484222325; /* FNV-1a */
	char id[64];
	int fd = open("/proc/sys/kernel/random/boot_id", O_RDONLY | O_CLOEXEC);
	ssize_t n = fd >= 0 ? read(fd, id, sizeof(id)) : 0;

	if (fd >= 0)
		close(fd);
	for (ssize_t i = 0; i < n && id[i] != '\n'; i++)
		hash = (hash ^ (uint8_t)id[i]) * 0x100000001b3;
	return (int64_t)(hash ? hash : 1);
}
