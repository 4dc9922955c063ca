/* SPDX-License-Identifier: MIT */
/* Scheme "i2c": the native bus over DS2482 and their kin. */
#include <sys/stat.h>

#include "hal/ds2482/i2c_master.h"
#include "hal/native/native.h"

#define I2C_MAJOR 89 /* Linux Documentation/admin-guide/devices.txt */

static const struct bus_look looks[] = {
	{.begin = "/",
         .root = "",
         .type = S_IFCHR,
         .major = I2C_MAJOR,
         .wrong = "no I2C adapter: ls /dev/i2c-* lists them",
         .remedy = "ls /dev/i2c-* lists the adapters, owsd --board names what is missing"},
	{0},
};

static int i2c_bus_create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                          size_t why_size)
{
	return native_create(&i2c_bus, &ds2482_i2c_master, where, env, bus, why, why_size);
}

const struct bus_ops i2c_bus = {
	.scheme = "i2c",
	.summary = "1-Wire devices on DS2482-100, -101, -800, DS2483 or DS2484",
	.create = i2c_bus_create,
	.caches = "",
	.board_advice = true,
	.looks = looks,
	NATIVE_BUS_SLOTS,
};
