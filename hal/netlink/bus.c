/* SPDX-License-Identifier: MIT */
/* The buses of scheme "w1": over netlink if the target says so, else over sysfs. */
#include "hal/native/native.h"
#include "hal/netlink/master.h"
#include "hal/w1/w1.h"

static const struct bus_ops netlink_bus = {
	.scheme = "w1",
	.summary = "1-Wire devices on the kernel's masters (netlink)",
	NATIVE_BUS_SLOTS,
};

static int netlink_bus_create(const char *where, const struct bus_env *env, struct bus **bus,
                              char *why, size_t why_size)
{
	if (w1_is_netlink(where))
		return native_create(&netlink_bus, &w1_netlink_master, where, env, bus, why,
		                     why_size);
	return w1_sysfs_bus.create(where, env, bus, why, why_size);
}

static const struct bus_look looks[] = {
	{.begin = "w1_bus_master",
         .root = "/sys/bus/w1/devices/",
         .remedy = "ls /sys/bus/w1/devices lists the masters"},
	{.after = "netlink/",
         .begin = "w1_bus_master",
         .root = "/sys/bus/w1/devices/",
         .remedy = "ls /sys/bus/w1/devices lists the masters"},
	{0},
};

const struct bus_ops w1_bus = {
	.scheme = "w1",
	.summary = "1-Wire devices of the kernel's drivers (sysfs)",
	.create = netlink_bus_create,
	.caches = "netlink",
	.looks = looks,
};
