/* SPDX-License-Identifier: MIT */
/* What the error of a library means that does not tell "no such file" from "no GPIO chip". */
#include <errno.h>
#include <sys/stat.h>

#include "hal/gpio/api.h"

int gpio_open_error(const char *path, int err)
{
	struct stat file;

	return (err == -ENODEV || err == -ENOENT) && stat(path, &file) == 0 ? -ENOTTY : err;
}
