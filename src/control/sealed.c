/* SPDX-License-Identifier: MIT */
/* The memory of a giver: made by owsd, sealed, mapped by both. */
#include <errno.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "src/control/sealed.h"

/* Younger than the headers of some machines that build owsd. */
#ifndef MFD_NOEXEC_SEAL
#define MFD_NOEXEC_SEAL 0x0008U
#endif

static int create(void)
{
	int fd = memfd_create("owsd-giver", MFD_CLOEXEC | MFD_ALLOW_SEALING | MFD_NOEXEC_SEAL);

	if (fd < 0 && errno == EINVAL)
		fd = memfd_create("owsd-giver", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	return fd < 0 ? -errno : fd;
}

static int allocate(int fd, size_t size)
{
	int err;

	if (ftruncate(fd, (off_t)size) < 0)
		return -errno;
	do {
		err = posix_fallocate(fd, 0, (off_t)size);
	} while (err == EINTR);
	return -err;
}

int sealed_make(size_t size, char **base)
{
	int fd = create(), err;
	void *mapped;

	if (fd < 0)
		return fd;
	err = allocate(fd, size);
	if (!err && fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) < 0)
		err = -errno;
	mapped = err ? MAP_FAILED : mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
	if (!err && mapped == MAP_FAILED)
		err = -errno;
	if (err) {
		close(fd);
		return err;
	}
	*base = mapped;
	return fd;
}

void sealed_free(char *base, size_t size)
{
	if (!base)
		return;
	munlock(base, size); /* of locked memory the kernel gives nothing back */
	madvise(base, size, MADV_REMOVE);
	munmap(base, size);
}
