/* SPDX-License-Identifier: MIT */
/* The lock on a chip: the process that drives it locks a byte of the adapter's device file. */
#include <errno.h>
#include <fcntl.h>

#include "hal/base/chip_lock.h"

/*
 * The lock belongs to the descriptor (OFD lock), so it also keeps two targets of one process apart.
 * The kernel does not report the holder of such a lock. So the holder takes an ordinary lock too,
 * 256 bytes further on, which only names the process: it goes as soon as the process closes any
 * descriptor of the adapter.
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
