/* SPDX-License-Identifier: MIT */
#include "hal/w1/netlink.h"

#define LOOK_NS (5 * NATIVE_S)

static int create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                  size_t why_size)
{
	if (w1_is_netlink(where))
		return w1_netlink_bus.create(where, env, bus, why, why_size);
	return native_create(&w1_bus, &w1_master, where, env, bus, why, why_size);
}

/* A master that comes while others serve is one channel more; one that goes has no slaves. */
static void look(struct native *native, int64_t now)
{
	struct w1_master *master = (struct w1_master *)native->master;

	if (!native->up || now < master->look_ns)
		return;
	master->look_ns = now + LOOK_NS;
	w1_look_for_masters(master);
	for (; native->channels < master->count; native->channels++)
		native->channel[native->channels] =
			(struct channel){.link = &master->links[native->channels].link};
}

static int64_t step(struct bus *bus, int64_t now)
{
	struct native *native = (struct native *)bus;
	struct w1_master *master = (struct w1_master *)native->master;

	look(native, now);
	int64_t next = native_step(bus, now);
	return native->up && master->look_ns < next ? master->look_ns : next;
}

const struct bus_ops w1_bus = {
	.scheme = "w1",
	.summary = "1-Wire devices of the kernel's drivers (sysfs)",
	.depth = NATIVE_DEPTH,
	.searches = true,
	.create = create,
	.destroy = native_destroy,
	.submit = native_submit,
	.step = step,
	.cancel = native_cancel,
	.suspend = native_suspend,
	.there = native_there,
	.counters = native_counters,
};
