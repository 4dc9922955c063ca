/* SPDX-License-Identifier: MIT */
/* The bus over sysfs: a native bus that looks for masters and slaves that come later. */
#include "hal/w1/w1.h"
#include "hal/native/native.h"
#include "hal/native/state.h"
#include "hal/w1/master.h"
#include "hal/w1/uevent.h"

#define LOOK_NS (5 * NATIVE_S)
#define UEVENTS_NS (NATIVE_S / 4)

static int create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                  size_t why_size)
{
	return native_create(&w1_sysfs_bus, &w1_master, where, env, bus, why, why_size);
}

/* A list that has changed is read at once. */
static void take_uevents(struct native *native, struct w1_master *master, int64_t now)
{
	if (now < master->uevents_ns)
		return;
	master->uevents_ns = now + UEVENTS_NS;
	if (!w1_uevents_taken(master->uevents))
		return;
	master->look_ns = now;
	for (unsigned n = 0; n < native->channels; n++)
		native->channel[n].search_ns = now;
}

/* A master that comes while others serve is one channel more; one that goes has no slaves. */
static void look(struct native *native, struct w1_master *master, int64_t now)
{
	if (now < master->look_ns)
		return;
	master->look_ns = now + LOOK_NS;
	w1_look_for_masters(master);
	for (; native->channels < master->count; native->channels++)
		native->channel[native->channels] = (struct channel){
			.link = &master->links[native->channels].link};
}

static int64_t step(struct bus *bus, int64_t now)
{
	struct native *native = (struct native *)bus;
	struct w1_master *master = (struct w1_master *)native->master;

	if (native->up) {
		take_uevents(native, master, now);
		look(native, master, now);
	}
	int64_t next = native_step(bus, now);
	if (native->up && master->look_ns < next)
		next = master->look_ns;
	if (native->up && master->uevents >= 0 && master->uevents_ns < next)
		next = master->uevents_ns;
	return next;
}

const struct bus_ops w1_sysfs_bus = {
	.scheme = "w1",
	.summary = "1-Wire devices of the kernel's drivers (sysfs)",
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
