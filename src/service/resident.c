/* SPDX-License-Identifier: MIT */
/* The pages that the start of a program leaves mapped. */
#include <link.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "src/service/resident.h"

static int drop_object(struct dl_phdr_info *object, size_t size, void *arg)
{
	uintptr_t page = (uintptr_t) * (const long *)arg;

	(void)size;
	for (int i = 0; i < object->dlpi_phnum; i++) {
		const ElfW(Phdr) *part = &object->dlpi_phdr[i];
		uintptr_t begin = (uintptr_t)object->dlpi_addr + (uintptr_t)part->p_vaddr;
		uintptr_t from = begin & -page, to = (begin + part->p_memsz + page - 1) & -page;

		/* what the loader may have written is no page of the file any more */
		if (part->p_type == PT_LOAD && !(part->p_flags & PF_W))
			madvise((void *)from, to - from, MADV_DONTNEED);
	}
	return 0;
}

/* A breakpoint is a page of one's own, which would be lost. */
static bool is_traced(void)
{
	FILE *status = fopen("/proc/self/status", "r");
	char line[128];
	long tracer = 0;

	while (status && fgets(line, sizeof(line), status))
		if (sscanf(line, "TracerPid: %ld", &tracer) == 1)
			break;
	if (status)
		fclose(status);
	return !status || tracer != 0;
}

void resident_drop_start(void)
{
	long page = sysconf(_SC_PAGESIZE);

	if (!is_traced())
		dl_iterate_phdr(drop_object, &page);
}
