/* SPDX-License-Identifier: MIT */
/* What a controller gets of a generation: its memory, which both map, and its rights. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/memory/control/grant.h"
#include "src/memory/shm/segment.h"

/* Younger than the headers of some machines that build owsd. */
#ifndef MFD_NOEXEC_SEAL
#define MFD_NOEXEC_SEAL 0x0008U
#endif

static int sealed_create(void)
{
	int fd = memfd_create("owsd-controller", MFD_CLOEXEC | MFD_ALLOW_SEALING | MFD_NOEXEC_SEAL);

	if (fd < 0 && errno == EINVAL)
		fd = memfd_create("owsd-controller", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	return fd < 0 ? -errno : fd;
}

/* Each open() of its own counts with the file, as a copy of a descriptor does not. */
static int open_again(int fd)
{
	char path[32];
	int again;

	snprintf(path, sizeof(path), "/proc/self/fd/%d", fd);
	again = open(path, O_RDWR | O_CLOEXEC);
	if (again < 0)
		return -errno;
	return again;
}

static int map_memory(int fd, size_t size, char **base)
{
	void *mapped = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);

	if (mapped == MAP_FAILED)
		return -errno;
	*base = mapped;
	return 0;
}

static void sealed_unmap(char *base, size_t size)
{
	if (base)
		munmap(base, size);
}

static int open_both(int fd, int *own)
{
	int theirs = open_again(fd);

	if (theirs < 0)
		return theirs;
	*own = open_again(fd);
	if (*own >= 0)
		return theirs;
	close(theirs);
	return *own;
}

/*
 * Zeroed memory of that size, all of it allocated, mapped, and sealed against shrinking, growing
 * and more seals. Returns the descriptor for the controller, or a negative errno; own is one that
 * stays here.
 */
static int sealed_make(size_t size, char **base, int *own)
{
	int fd = sealed_create(), err, theirs;

	if (fd < 0)
		return fd;
	err = ftruncate(fd, (off_t)size) < 0 ? -errno : segment_allocate(fd, size);
	if (!err && fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) < 0)
		err = -errno;
	if (!err)
		err = map_memory(fd, size, base);
	theirs = err ? err : open_both(fd, own);
	if (theirs < 0 && !err)
		sealed_unmap(*base, size);
	close(fd);
	return theirs;
}

int grant_make(struct control_grant *grant, const struct controller_layout *layout,
               const struct rights *rights, const struct control_seat *seat)
{
	*grant = (struct control_grant){
		.memory.layout = layout,
		.size = layout->header.size,
		.rights = calloc((size_t)layout->header.slot_count / 32 + 1, sizeof(uint32_t)),
		.memfd = -1,
		.own = -1,
	};
	if (!grant->rights)
		return -ENOMEM;
	grant->memfd = sealed_make(grant->size, &grant->memory.base, &grant->own);
	if (grant->memfd < 0) {
		int err = grant->memfd;

		grant->memfd = grant->own = -1;
		grant->memory.base = NULL;
		grant_free(grant);
		return err;
	}
	if (seat->commands)
		grant->allowed = rights_fill(rights, &seat->peer, grant->rights);
	controller_build(&grant->memory, seat->who.serial);
	for (uint32_t i = 0; i < layout->header.slot_count; i++)
		controller_allow(&grant->memory, i, grant->rights[i / 32] >> i % 32 & 1);
	controller_state(&grant->memory, OWS_STATE_LIVE);
	return 0;
}

void grant_free(struct control_grant *grant)
{
	sealed_unmap(grant->memory.base, grant->size);
	if (grant->memory.base && grant->memfd >= 0)
		close(grant->memfd);
	if (grant->memory.base && grant->own >= 0)
		close(grant->own);
	free(grant->rights);
	*grant = (struct control_grant){.memfd = -1, .own = -1};
}

bool grant_is_empty(int own)
{
	struct stat st;

	return fstat(own, &st) < 0 || st.st_blocks == 0;
}
