/* SPDX-License-Identifier: MIT */
/* The lock on a chip: a byte of the adapter's device file, locked by whoever drives the chip. */
#include <errno.h>
#include <fcntl.h>

#include "hal/ds2482/chip_lock.h"

/*
 * The lock belongs to the descriptor (OFD), so that two targets of one process hold each other off
 * too. The kernel does not say who has such a lock; so the same process holds an ordinary one
 * beside it, 256 bytes on, which decides nothing: it goes as soon as any descriptor of the adapter
 * is closed.
 */
#define NAME_OFFSET 256

static struct flock at(short type, off_t byte)
{
	return (struct flock){.l_type = type, .l_whence = SEEK_SET, .l_start = byte, .l_len = 1};
}

static int holder_of(int fd, uint8_t address)
{
	struct flock name = at(F_WRLCK, NAME_OFFSET + address);

	if (fcntl(fd, F_GETLK, &name) < 0)
		return 0;
	return name.l_type != F_UNLCK && name.l_pid > 0 ? (int)name.l_pid : 0;
}

int chip_lock(int fd, uint8_t address, int *holder)
{
	struct flock lock = at(F_WRLCK, address), name = at(F_WRLCK, NAME_OFFSET + address);

	if (fcntl(fd, F_OFD_SETLK, &lock) < 0) {
		if (errno != EAGAIN && errno != EACCES)
			return -errno;
		*holder = holder_of(fd, address);
		return -EADDRINUSE;
	}
	(void)fcntl(fd, F_SETLK, &name);
	return 0;
}

void chip_unlock(int fd, uint8_t address)
{
	struct flock lock = at(F_UNLCK, address), name = at(F_UNLCK, NAME_OFFSET + address);

	(void)fcntl(fd, F_SETLK, &name);
	(void)fcntl(fd, F_OFD_SETLK, &lock);
}

bool chip_locked(int fd, uint8_t address)
{
	struct flock lock = at(F_WRLCK, address);

	return fcntl(fd, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}
