/* SPDX-License-Identifier: MIT */
/* Scheme "i2c": `i2c:/dev/i2c-1`, `i2c:/dev/i2c-1:0x18`, `i2c:/dev/i2c-1:0x18.3`. */
#include "ds2482.h"
#include "i2c_dev.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int open_adapter(void *ctx, const struct bus_env *env, struct i2c_adapter **adapter,
                        char *why, size_t why_size)
{
	const char *path = ctx;
	int err = i2c_dev_open(path, adapter);

	(void)env;
	switch (err) {
	case 0:
		break;
	case -EACCES:
	case -EPERM:
		snprintf(why, why_size, "no permission for %s: the user has to be in the group "
		         "that owns it (i2c)", path);
		err = -EACCES;
		break;
	case -ENOENT:
	case -ENXIO:
	case -ENODEV:
		snprintf(why, why_size, "no %s: switch I2C on (Raspberry Pi: dtparam=i2c_arm=on), "
		         "load the module i2c-dev", path);
		err = -ENODEV;
		break;
	case -EOPNOTSUPP:
		snprintf(why, why_size, "this owsd was built without libi2c and cannot open %s",
		         path);
		break;
	case -ENOTTY:
		snprintf(why, why_size, "%s is no I2C adapter", path);
		break;
	default:
		snprintf(why, why_size, "%s: %s", path, strerror(-err));
		break;
	}
	return err;
}

static int create(const char *where, const struct bus_env *env, struct link_master **master,
                  char *why, size_t why_size)
{
	size_t len = strcspn(where, ":");
	struct ds2482_source source = {.open = open_adapter, .destroy = free};
	char *path = malloc(len + 1);

	if (!path)
		return -ENOMEM;
	memcpy(path, where, len);
	path[len] = '\0';
	if (path[0] != '/') {
		snprintf(why, why_size, "\"%s\": expected an adapter, as /dev/i2c-1", where);
		free(path);
		return -EINVAL;
	}
	source.ctx = path;
	source.name = path;
	return ds2482_create(&ds2482_i2c_master, env, &source, where + len, master, why, why_size);
}

const struct link_master_ops ds2482_i2c_master = {
	.scheme = "i2c",
	.summary = "DS2482-100, -101, -800, DS2483, DS2484 on an I2C adapter",
	.create = create,
	.open = ds2482_open,
	.grow = ds2482_grow,
	.close = ds2482_close,
	.channels = ds2482_channels,
	.channel = ds2482_channel,
	.destroy = ds2482_destroy,
};
