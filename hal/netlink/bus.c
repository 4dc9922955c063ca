/* SPDX-License-Identifier: MIT */
/* The buses of scheme "w1": over netlink if the target says so, else over sysfs. */
#include "hal/native/native.h"
#include "hal/native/state.h"
#include "hal/netlink/master.h"
#include "hal/w1/w1.h"

#define LOOK_NS (5 * NATIVE_S)

/* A master that comes while others serve is one channel more; one that goes has no devices. */
static void look(struct native *native, int64_t now)
{
	struct w1_netlink *netlink = (struct w1_netlink *)native->master;

	if (!native->up || now < netlink->look_ns)
		return;
	netlink->look_ns = now + LOOK_NS;
	w1_netlink_look(netlink);
	unsigned count = native->master->ops->channels(native->master);
	for (; native->channels < count; native->channels++) {
		struct link *link = native->master->ops->channel(native->master, native->channels);

		native->channel[native->channels] = (struct channel){.link = link};
	}
}

static int64_t step(struct bus *bus, int64_t now)
{
	struct native *native = (struct native *)bus;
	const struct w1_netlink *netlink = (const struct w1_netlink *)native->master;

	look(native, now);
	int64_t next = native_step(bus, now);
	return native->up && netlink->look_ns < next ? netlink->look_ns : next;
}

static const struct bus_ops netlink_bus = {
	.scheme = "w1",
	.summary = "1-Wire devices on the kernel's masters (netlink)",
	.depth = NATIVE_DEPTH,
	.searches = true,
	.destroy = native_destroy,
	.submit = native_submit,
	.step = step,
	.suspend = native_suspend,
	.there = native_there,
	.counters = native_counters,
};

static int create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                  size_t why_size)
{
	if (w1_is_netlink(where))
		return native_create(&netlink_bus, &w1_netlink_master, where, env, bus, why,
		                     why_size);
	return w1_sysfs_bus.create(where, env, bus, why, why_size);
}

const struct bus_ops w1_bus = {
	.scheme = "w1",
	.summary = "1-Wire devices of the kernel's drivers (sysfs)",
	.create = create,
};
