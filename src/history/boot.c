/* SPDX-License-Identifier: MIT */
/* The kernel's boot id, as a number. */
#include "src/history/boot.h"
#include "src/signal/hash.h"

#include <fcntl.h>
#include <unistd.h>

int64_t history_boot_present(void)
{
	char id[64];
	int fd = open("/proc/sys/kernel/random/boot_id", O_RDONLY | O_CLOEXEC);
	ssize_t n = fd >= 0 ? read(fd, id, sizeof(id)) : 0, len = 0;
	uint64_t hash;

	if (fd >= 0)
		close(fd);
	while (len < n && id[len] != '\n')
		len++;
	hash = hash_text(HASH_BEGIN, id, (size_t)len);
	return (int64_t)(hash ? hash : 1);
}
