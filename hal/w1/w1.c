/* SPDX-License-Identifier: MIT */
/* The bus over sysfs: a native bus that hears of masters and slaves that come later. */
#include "hal/w1/w1.h"
#include "hal/base/time.h"
#include "hal/native/native.h"
#include "hal/w1/master.h"
#include "hal/w1/state.h"
#include "hal/w1/uevent.h"

#define UEVENTS_NS (NS_PER_S / 4)

static int w1_create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                     size_t why_size)
{
	return native_create(&w1_sysfs_bus, &w1_master, where, env, bus, why, why_size);
}

/* A list that has changed is read at once. */
static void take_uevents(struct bus *bus, struct w1_master *master, int64_t now)
{
	if (now < master->uevents_ns)
		return;
	master->uevents_ns = now + UEVENTS_NS;
	if (w1_uevents_taken(master->uevents))
		native_look(bus, now);
}

static int64_t w1_step(struct bus *bus, int64_t now)
{
	struct w1_master *master = (struct w1_master *)native_master(bus);

	if (master)
		take_uevents(bus, master, now);
	int64_t next = native_step(bus, now);
	master = (struct w1_master *)native_master(bus);
	return master && master->uevents >= 0 && master->uevents_ns < next ? master->uevents_ns
	                                                                   : next;
}

const struct bus_ops w1_sysfs_bus = {
	.scheme = "w1",
	.summary = "1-Wire devices of the kernel's drivers (sysfs)",
	.create = w1_create,
	.step = w1_step,
	NATIVE_BUS_SLOTS_BUT_STEP,
};
