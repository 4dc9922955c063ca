/* SPDX-License-Identifier: MIT */
/* The kernel's masters, each a link: the target's, those that come, those that go. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/native/native.h"
#include "hal/w1/link.h"
#include "hal/w1/master.h"
#include "hal/w1/name.h"
#include "hal/w1/state.h"
#include "hal/w1/uevent.h"

static int take_where(struct w1_master *master, const char *where, char *why, size_t why_size)
{
	static const char root[] = "root=";
	const char *path = where + sizeof(root) - 1;

	snprintf(master->tree.root, sizeof(master->tree.root), "%s", W1_ROOT);
	if (!*where)
		return 0;
	if (strncmp(where, root, sizeof(root) - 1) != 0) {
		master->only = w1_master_number(where);
		if (!master->only)
			snprintf(why, why_size,
			         "'w1:' is followed by nothing or by a master, as in "
			         "w1:w1_bus_master1");
		return master->only ? 0 : -EINVAL;
	}
	const char *slash = strrchr(path, '/');
	size_t len = strlen(path);
	master->only = slash ? w1_master_number(slash + 1) : 0;
	if (master->only)
		len = (size_t)(slash - path);
	if (path[0] != '/' || len >= sizeof(master->tree.root)) {
		snprintf(why, why_size, "'w1:root=' is followed by the whole path of a directory");
		return -EINVAL;
	}
	snprintf(master->tree.root, sizeof(master->tree.root), "%.*s", (int)len, path);
	return 0;
}

static int w1_create_master(const char *where, const struct bus_env *env, struct link_master **out,
                            char *why, size_t why_size)
{
	struct w1_master *master = calloc(1, sizeof(*master));

	if (!master)
		return -ENOMEM;
	int err = take_where(master, where, why, why_size);
	if (err) {
		free(master);
		return err;
	}
	master->master = (struct link_master){.ops = &w1_master, .env = env};
	master->tree.env = env;
	master->slaves.tree = &master->tree;
	master->uevents = -1;
	*out = &master->master;
	return 0;
}

static void w1_destroy_master(struct link_master *base)
{
	w1_master_deafen(base);
	free(base);
}

unsigned w1_master_only(const struct link_master *base)
{
	return ((const struct w1_master *)base)->only;
}

bool w1_master_has(const struct link_master *base, unsigned number)
{
	char name[W1_MASTER_NAME_MAX];

	w1_master_name(number, name);
	return w1_exists(&((const struct w1_master *)base)->tree, name, "");
}

void w1_master_deafen(struct link_master *base)
{
	w1_uevents_close(&((struct w1_master *)base)->uevents);
}

static bool has_link(const struct w1_master *master, unsigned number)
{
	for (unsigned i = 0; i < master->count; i++)
		if (master->links[i].bulk.number == number)
			return true;
	return false;
}

/*
 * The kernel numbers its masters from 1 on and gives the lowest that is free. It may get more at
 * any time. A master that goes has no slaves, and keeps its channel.
 */
static int w1_grow(struct link_master *base, char *why, size_t why_size)
{
	struct w1_master *master = (struct w1_master *)base;
	unsigned first = master->only ? master->only : 1;
	unsigned last = master->only ? master->only : W1_MASTERS;

	(void)why;
	(void)why_size;
	for (unsigned n = first; n <= last && master->count < W1_MASTERS; n++) {
		if (has_link(master, n) || !w1_master_has(base, n))
			continue;
		struct w1_link *link = &master->links[master->count];
		*link = (struct w1_link){.link = {.ops = &w1_link_ops,
		                                  .facts = &w1_link_facts,
		                                  .env = master->master.env,
		                                  .chip = master->count,
		                                  .driver = &w1_driver_ops},
		                         .master = master,
		                         .bulk = {.number = n, .channel = (uint8_t)master->count}};
		master->count++;
	}
	return !master->only;
}

static int open_masters(struct link_master *base, char *why, size_t why_size)
{
	struct w1_master *master = (struct w1_master *)base;

	master->count = 0;
	master->slaves.count = 0;
	master->tree.told_rights = false;
	w1_grow(base, why, why_size);
	if (master->count) {
		if (strcmp(master->tree.root, W1_ROOT) == 0)
			master->uevents = w1_uevents_open();
		return 0;
	}
	if (master->only)
		snprintf(why, why_size, "the kernel has no w1_bus_master%u", master->only);
	else
		snprintf(why, why_size,
		         "no 1-Wire master in the kernel: modprobe its driver, or "
		         "dtoverlay=w1-gpio on a Raspberry Pi");
	return -ENODEV;
}

static void close_masters(struct link_master *base)
{
	((struct w1_master *)base)->count = 0;
	w1_master_deafen(base);
}

/* Directories say what is there without a look at any wire. */
static int w1_visible(struct link_master *base, uint64_t *mark)
{
	const struct w1_master *master = (const struct w1_master *)base;
	unsigned first = master->only ? master->only : 1;
	unsigned last = master->only ? master->only : W1_MASTERS;

	for (unsigned n = first; n <= last; n++)
		if (w1_master_has(base, n))
			*mark |= UINT64_C(1) << n % 64;
	return *mark != 0;
}

static unsigned w1_channels(struct link_master *base)
{
	return ((struct w1_master *)base)->count;
}

static struct link *w1_channel(struct link_master *base, unsigned n)
{
	return &((struct w1_master *)base)->links[n].link;
}

const struct link_master_ops w1_master = {
	.create = w1_create_master,
	.open = open_masters,
	.grow = w1_grow,
	.close = close_masters,
	.visible = w1_visible,
	.channels = w1_channels,
	.channel = w1_channel,
	.destroy = w1_destroy_master,
	.slow = true,
};

/* --- The bus over sysfs: a native bus that hears of masters and slaves that come later ------- */

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
