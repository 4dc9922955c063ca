/* SPDX-License-Identifier: MIT */
/*
 * Scheme "i2c": `i2c:/dev/i2c-1`, `i2c:/dev/i2c-1:0x18`, `i2c:/dev/i2c-1:0x18.3`, `i2c:auto`; when
 * to look for other programs on the adapter, and what to say of them.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "hal/base/rivals.h"
#include "hal/base/time.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/every.h"
#include "hal/ds2482/i2c_dev.h"
#include "hal/ds2482/i2c_master.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/look.h"
#include "hal/ds2482/master.h"
#include "hal/ds2482/power.h"
#include "hal/native/native.h"

#define I2C_MAJOR 89 /* Linux Documentation/admin-guide/devices.txt */
#define LOOK_NS (60 * NS_PER_S)
#define QUIET_NS (600 * NS_PER_S) /* so long after its last sign, what was not seen has gone */
/* So many errors between two looks are more than noise now and then. */
#define MANY 10

static int open_adapter(void *ctx, const struct bus_env *env, struct i2c_adapter **adapter,
                        char *why, size_t why_size)
{
	const struct rivals_device device = {
		ctx, ctx,
		"switch I2C on (Raspberry Pi: dtparam=i2c_arm=on), load the module i2c-dev", "i2c"};
	int err = i2c_dev_open(ctx, adapter);

	(void)env;
	if (err == -EOPNOTSUPP)
		snprintf(why, why_size, "this owsd was built without libi2c and cannot open %s",
		         device.name);
	else if (err == -ENOTTY)
		snprintf(why, why_size, "%s is no I2C adapter", device.name);
	else if (err)
		err = rivals_refused(err, &device, 0, why, why_size);
	return err;
}

static void explain_driver(void *ctx, uint8_t address, char *why, size_t why_size)
{
	char driver[32], client[24];

	i2c_driver(ctx, I2C_SYS_ROOT, address, driver, sizeof(driver), client, sizeof(client));
	if (driver[0])
		snprintf(why, why_size,
		         "0x%02x on %s is claimed by the kernel's %s driver: use target w1, or "
		         "echo %s > /sys/bus/i2c/drivers/%s/unbind",
		         (unsigned)address, (const char *)ctx, driver, client, driver);
	else
		snprintf(why, why_size,
		         "0x%02x on %s is claimed by a kernel driver: use target w1, or unbind it",
		         (unsigned)address, (const char *)ctx);
}

static int is_adapter_there(void *ctx, const struct bus_env *env, uint8_t chips, uint64_t *mark)
{
	(void)env;
	return i2c_look(ctx, I2C_SYS_ROOT, chips, mark);
}

static unsigned list_adapters(void *ctx, unsigned *numbers, unsigned max)
{
	(void)ctx;
	return i2c_list(I2C_DEV_ROOT, numbers, max);
}

static int make_adapter(void *ctx, unsigned number, const struct bus_env *env,
                        struct link_master **master)
{
	char where[32], why[100];

	(void)ctx;
	snprintf(where, sizeof(where), I2C_DEV_ROOT "/i2c-%u", number);
	return ds2482_i2c_master.create(where, env, master, why, sizeof(why));
}

/* The kernel calls its adapters i2c-N; a path that misses the dash waits for ever. */
static bool misses_dash(const char *path)
{
	const char *name = strrchr(path, '/') + 1;

	return !strncmp(name, "i2c", 3) && name[3] >= '0' && name[3] <= '9';
}

static int i2c_master_create(const char *where, const struct bus_env *env,
                             struct link_master **master, char *why, size_t why_size)
{
	size_t len = strcspn(where, ":");
	struct ds2482_source source = {.open = open_adapter,
	                               .visible = is_adapter_there,
	                               .explain = explain_driver,
	                               .destroy = free,
	                               .proc = RIVALS_PROC};
	static const struct every_source every = {.list = list_adapters, .make = make_adapter};
	char *path;

	if (strcmp(where, "auto") == 0)
		return every_create(env, &every, master);
	path = malloc(len + 1);
	if (!path)
		return -ENOMEM;
	memcpy(path, where, len);
	path[len] = '\0';
	if (path[0] != '/') {
		snprintf(why, why_size, "\"%s\": expected auto, or an adapter as /dev/i2c-1",
		         where);
		free(path);
		return -EINVAL;
	}
	if (misses_dash(path)) {
		snprintf(why, why_size, "no adapter is called \"%s\": write %.*s-%s", path,
		         (int)(strrchr(path, '/') + 4 - path), path, strrchr(path, '/') + 4);
		free(path);
		return -EINVAL;
	}
	source.ctx = path;
	source.name = path;
	return ds2482_create(&ds2482_i2c_master, env, &source, where + len, master, why, why_size);
}

/* A chip that was changed is worth a look of its own, however short the last one is ago. */
static bool due(struct ds2482_master *master, int64_t now)
{
	int64_t *next = master->changed ? &master->changed_look_ns : &master->look_ns;

	if (now < *next)
		return false;
	*next = now + LOOK_NS;
	return true;
}

/* What was seen of it, where no program was. */
static void print_change(struct ds2482_master *master, uint8_t changed)
{
	const char *name = master->source.name;

	if (changed)
		snprintf(master->trouble, sizeof(master->trouble),
		         "0x%02x on %s was reset or changed by another program (owserver? the "
		         "kernel's driver?), or lost its supply: sudo owsd --board names programs",
		         changed, name);
	else
		snprintf(master->trouble, sizeof(master->trouble),
		         "commands on %s fail again and again: does another program use it, as an "
		         "owserver? sudo owsd --board names programs",
		         name);
}

static void look(struct ds2482_master *master, int64_t now)
{
	char who[RIVALS_TEXT];
	bool was_named = master->named;
	bool seen = master->changed || master->failures >= MANY;

	master->named = rivals_find(master->source.proc, master->source.name, who, sizeof(who)) > 0;
	if (master->named) {
		snprintf(master->trouble, sizeof(master->trouble),
		         "%s is also open in %s: two programs on one DS2482 disturb each other",
		         master->source.name, who);
	} else if (seen) {
		if (was_named || !*master->trouble)
			print_change(master, master->changed);
		master->trouble_ns = now;
	} else if (was_named || now - master->trouble_ns >= QUIET_NS) {
		master->trouble[0] = '\0';
	}
	master->changed = 0;
	master->failures = 0;
}

void ds2482_trouble(struct link_master *base, bool failed, char *text, size_t size)
{
	struct ds2482_master *master = (struct ds2482_master *)base;
	int64_t now = ds2482_now(master);

	master->failures += failed;
	if (master->source.proc && due(master, now))
		look(master, now);
	snprintf(text, size, "%s", master->trouble);
}

const struct link_master_ops ds2482_i2c_master = {
	.create = i2c_master_create,
	.option = ds2482_option,
	.open = ds2482_open,
	.grow = ds2482_grow,
	.close = ds2482_close,
	.trouble = ds2482_trouble,
	.visible = ds2482_visible,
	.channels = ds2482_channels,
	.channel = ds2482_channel,
	.cost = ds2482_cost,
	.destroy = ds2482_destroy,
};

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
