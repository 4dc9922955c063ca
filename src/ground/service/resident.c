/* SPDX-License-Identifier: MIT */
/* The pages that the start of a program leaves mapped, and what malloc keeps of what was freed. */
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h> /* says whose malloc it is */
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "src/ground/service/resident.h"

struct mapping {
	uintptr_t from, to;
	bool of_file; /* and cannot be written */
};

static void resident_line(struct mapping *mapping, const char *line)
{
	unsigned long from, to, kib;
	char rights[5], path[2];

	/* NOLINTBEGIN(cert-err34-c): the kernel writes them */
	if (sscanf(line, "%lx-%lx %4s", &from, &to, rights) == 3) {
		mapping->from = from;
		mapping->to = to;
		mapping->of_file = !strchr(rights, 'w') && strchr(rights, 'p') &&
		                   sscanf(line, "%*s %*s %*s %*s %*s %1s", path) == 1 &&
		                   *path == '/';
	} else if (mapping->of_file && sscanf(line, "Anonymous: %lu", &kib) == 1 && kib == 0) {
		madvise((void *)mapping->from, mapping->to - mapping->from, MADV_DONTNEED);
	}
	/* NOLINTEND(cert-err34-c) */
}

void resident_drop_start(void)
{
	int fd = open("/proc/self/smaps", O_RDONLY | O_CLOEXEC);
	struct mapping mapping = {0};
	char text[4096 + 1];
	size_t have = 0;
	ssize_t n;

	if (fd < 0)
		return;
	while (have < sizeof(text) - 1 &&
	       (n = read(fd, text + have, sizeof(text) - 1 - have)) > 0) {
		char *line = text, *end;

		have += (size_t)n;
		text[have] = '\0';
		for (; (end = strchr(line, '\n')) != NULL; line = end + 1) {
			*end = '\0';
			resident_line(&mapping, line);
		}
		have = strlen(line);
		memmove(text, line, have);
	}
	close(fd);
}

/*
 * Each block of 16 KiB or more is a mapping of its own. A mapping is zero when it is new, so
 * calloc() does not clear it, and a page that is not used takes no memory. free() gives it back to
 * the system, so what reading a file, or a large answer, took does not stay. A limit that is set
 * here is fixed; without it malloc raises it with each larger block that is freed, up to 32 MiB.
 * The heap grows by what is needed and a page, not by the 128 KiB that malloc adds otherwise. All
 * threads share it: otherwise each has one of its own, which grows for hours where one thread frees
 * what another allocated.
 */
void heap_give_back(void)
{
#ifdef __GLIBC__
	mallopt(M_MMAP_THRESHOLD, 16 * 1024);
	mallopt(M_TOP_PAD, 4096);
	mallopt(M_ARENA_MAX, 1);
#endif
}
