/* SPDX-License-Identifier: MIT */
/* The bus of target w1:netlink: which masters of the kernel there are, and when to look. */
#include "hal/native/state.h"
#include "hal/netlink/netlink.h"

#define LOOK_NS (5 * NATIVE_S)

static int create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                  size_t why_size)
{
	return native_create(&w1_netlink_bus, &w1_netlink_master, where, env, bus, why, why_size);
}

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

const struct bus_ops w1_netlink_bus = {
	.scheme = "w1",
	.summary = "1-Wire devices on the kernel's masters (netlink)",
	.depth = NATIVE_DEPTH,
	.searches = true,
	.create = create,
	.destroy = native_destroy,
	.submit = native_submit,
	.step = step,
	.suspend = native_suspend,
	.there = native_there,
	.counters = native_counters,
};
