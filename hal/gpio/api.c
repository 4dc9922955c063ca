/* SPDX-License-Identifier: MIT */
/* What an error, and a time, of a library means. */
#include <errno.h>
#include <sys/stat.h>

#include "hal/base/time.h"
#include "hal/gpio/api.h"

int gpio_open_error(const char *path, int err)
{
	struct stat file;

	return (err == -ENODEV || err == -ENOENT) && stat(path, &file) == 0 ? -ENOTTY : err;
}

int64_t gpio_boottime(int64_t monotonic_ns)
{
	return monotonic_ns + clock_ns(CLOCK_BOOTTIME) - clock_ns(CLOCK_MONOTONIC);
}
