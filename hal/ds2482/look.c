/* SPDX-License-Identifier: MIT */
/* What the kernel's files show about I2C adapters and their chips. */
#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include "hal/base/chip_lock.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/look.h"

static void mix(uint64_t *mark, uint64_t word)
{
	*mark = (*mark ^ word) * UINT64_C(0x100000001b3);
}

/* The minor number of a device file is the adapter's number, whatever the file's name. */
static void client_name(const char *path, uint8_t address, char *name, size_t size)
{
	struct stat st = {0};

	if (stat(path, &st))
		st.st_rdev = 0;
	snprintf(name, size, "%u-%04x", minor(st.st_rdev), (unsigned)address);
}

static ssize_t driver_link(const char *sys, const char *client, char *to, size_t size)
{
	char path[256];

	snprintf(path, sizeof(path), "%s/%s/driver", sys, client);
	return readlink(path, to, size);
}

int i2c_look(const char *path, const char *sys, uint8_t chips, uint64_t *mark)
{
	unsigned bound = 0, held = 0;
	struct stat st;
	int fd;

	fd = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
	if (fd < 0 || fstat(fd, &st)) {
		if (fd >= 0)
			close(fd);
		return 0;
	}
	for (unsigned i = 0; i < DS2482_ADDRESSES; i++) {
		uint8_t address = (uint8_t)(DS2482_FIRST_ADDRESS + i);
		char client[24], to[8];

		client_name(path, address, client, sizeof(client));
		if (driver_link(sys, client, to, sizeof(to)) >= 0)
			bound |= 1u << i;
		if (chip_locked(fd, address))
			held |= 1u << i;
	}
	close(fd);
	mix(mark, st.st_ino);
	mix(mark, (uint64_t)st.st_ctim.tv_sec);
	mix(mark, (uint64_t)st.st_ctim.tv_nsec);
	mix(mark, bound << 8 | held);
	return !chips || (chips & ~(bound | held));
}

void i2c_driver(const char *path, const char *sys, uint8_t address, char *driver,
                size_t driver_size, char *client, size_t client_size)
{
	char to[256], *name;
	ssize_t n;

	client_name(path, address, client, client_size);
	n = driver_link(sys, client, to, sizeof(to) - 1);
	to[n > 0 ? n : 0] = '\0';
	name = strrchr(to, '/');
	snprintf(driver, driver_size, "%s", name ? name + 1 : to);
}

static bool adapter_number(const char *name, unsigned *number)
{
	char *end;

	if (strncmp(name, "i2c-", 4) != 0 || name[4] < '0' || name[4] > '9')
		return false;
	*number = (unsigned)strtoul(name + 4, &end, 10);
	return !*end && *number < 1u << 20;
}

unsigned i2c_list(const char *root, unsigned *numbers, unsigned max)
{
	unsigned count = 0, number;
	DIR *dir = opendir(root);

	for (struct dirent *entry; dir && count < max && (entry = readdir(dir));) {
		unsigned at = count;

		if (!adapter_number(entry->d_name, &number))
			continue;
		for (; at > 0 && numbers[at - 1] > number; at--)
			numbers[at] = numbers[at - 1];
		numbers[at] = number;
		count++;
	}
	if (dir)
		closedir(dir);
	return count;
}
