/* SPDX-License-Identifier: MIT */
/* The kernel's 1-Wire masters as link masters, over the netlink connector. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/native/native.h"
#include "hal/netlink/run.h"
#include "hal/netlink/search.h"
#include "hal/w1/master.h"

#define FIRST_TRIES 3 /* lists that are asked for until a kernel is said not to answer */

/* --- One master as a link -------------------------------------------------------------------- */

/*
 * A part is one request. There are no single slots: first_slot() reads a byte and returns the first
 * of its slots; to the chips that are asked so the seven behind it mean nothing.
 */
static struct w1_netlink_link *link_of(struct link *link)
{
	return (struct w1_netlink_link *)link;
}

static int netlink_run(struct link *base, const struct link_part *part)
{
	struct w1_netlink_link *link = link_of(base);
	struct w1_request request;
	int err = part->after == LINK_STRONG ? -EOPNOTSUPP : 0;

	w1_request_begin(&request, link->number);
	if (!err && part->reset) {
		link->next_slot = -1;
		err = w1_request_add(&request, W1_RESET, NULL, 0, NULL);
	}
	if (!err && part->out_n)
		err = w1_request_add(&request, W1_WRITE, part->out, part->out_n, NULL);
	if (!err && part->in_n)
		err = w1_request_add(&request, W1_READ, NULL, part->in_n, part->in);
	return err || !request.count ? err : w1_netlink_run(link, &request);
}

static int first_slot(struct link *base, bool out, enum link_after after)
{
	struct w1_netlink_link *link = link_of(base);
	int slot = link->next_slot;
	uint8_t byte;
	const struct link_part part = {.in = &byte, .in_n = 1};

	if (!out || after == LINK_STRONG)
		return -EOPNOTSUPP;
	link->next_slot = -1;
	if (slot >= 0)
		return slot;
	int err = netlink_run(base, &part);
	return err ? err : byte & 1;
}

/* The kernel's driver sees to its chip; what is left to try is to ask again. */
static int netlink_recover(struct link *base, enum link_rung rung)
{
	const struct link_part reset = {.reset = true};

	if (rung != LINK_BUS_RESET)
		return -EOPNOTSUPP;
	int err = netlink_run(base, &reset);
	return err == -EHOSTDOWN ? 0 : err;
}

static void netlink_cost(const struct link *base, struct link_cost *cost)
{
	*cost = ((const struct w1_netlink_link *)base)->cost;
}

static const struct link_ops w1_netlink_link_ops = {
	.name = "w1 netlink",
	.run = netlink_run,
	.slot = first_slot,
	.search = w1_netlink_search,
	.verify = w1_netlink_verify,
	.recover = netlink_recover,
	.cost = netlink_cost,
};

/* --- The masters ------------------------------------------------------------------------------ */

static const char word[] = "netlink";

/* Is it "netlink", "netlink/...", of which this bus is? */
static bool is_netlink(const char *where)
{
	size_t n = sizeof(word) - 1;

	return strncmp(where, word, n) == 0 && (where[n] == '\0' || where[n] == '/');
}

static bool has_master(void *ctx, uint32_t master)
{
	return w1_master_has(((const struct w1_netlink *)ctx)->sysfs, master);
}

static const struct link_master_ops netlink_master;

/* Behind the word and a slash: what target w1 takes. */
static int netlink_create(const char *where, const struct bus_env *env, struct link_master **out,
                          char *why, size_t why_size)
{
	struct w1_netlink *netlink = calloc(1, sizeof(*netlink));
	const char *rest = where + sizeof(word) - 1;

	if (!netlink)
		return -ENOMEM;
	int err = w1_master.create(*rest ? rest + 1 : rest, env, &netlink->sysfs, why, why_size);
	if (err) {
		free(netlink);
		return err;
	}
	netlink->master = (struct link_master){.ops = &netlink_master, .env = env};
	netlink->talk = (struct w1_talk){
		.env = env, .has_master = has_master, .ctx = netlink, .fd = -1};
	*out = &netlink->master;
	return 0;
}

static void netlink_destroy(struct link_master *base)
{
	struct w1_netlink *netlink = (struct w1_netlink *)base;

	w1_talk_close(&netlink->talk);
	w1_master.destroy(netlink->sysfs);
	free(netlink);
}

static bool has_link(const struct w1_netlink *netlink, uint32_t number)
{
	for (unsigned i = 0; i < netlink->count; i++)
		if (netlink->links[i].number == number)
			return true;
	return false;
}

static const struct link_facts facts;

/* What the kernel has, each with a channel. Returns how many masters that are, or an error. */
static int add_links(struct w1_netlink *netlink)
{
	uint32_t numbers[NATIVE_CHANNELS], only = w1_master_only(netlink->sysfs);
	int n = -ETIMEDOUT;

	for (unsigned i = 0; i < (netlink->answered ? 1 : FIRST_TRIES) && n == -ETIMEDOUT; i++)
		n = w1_talk_masters(&netlink->talk, numbers, NATIVE_CHANNELS);
	for (int i = 0; i < n && netlink->count < NATIVE_CHANNELS; i++) {
		if (has_link(netlink, numbers[i]) || (only && numbers[i] != only))
			continue;
		struct w1_netlink_link *link = &netlink->links[netlink->count];
		*link = (struct w1_netlink_link){.link = {.ops = &w1_netlink_link_ops,
		                                          .facts = &facts,
		                                          .env = netlink->master.env,
		                                          .chip = netlink->count},
		                                 .netlink = netlink,
		                                 .number = numbers[i],
		                                 .next_slot = -1};
		netlink->count++;
	}
	return n;
}

/* The kernel may get more at any time. A master that goes has no devices, and keeps its channel. */
static int netlink_grow(struct link_master *base, char *why, size_t why_size)
{
	struct w1_netlink *netlink = (struct w1_netlink *)base;

	if (netlink->refused)
		return w1_master.grow(netlink->sysfs, why, why_size);
	add_links(netlink);
	return !w1_master_only(netlink->sysfs);
}

/*
 * These masters have no single slots, and the kernel does not look before it asks their driver for
 * one (Linux 6.1).
 */
static bool has_no_slots(void)
{
	static const char *const drivers[] = {"ds1wm", "omap_hdq"};
	char path[64];

	for (size_t i = 0; i < sizeof(drivers) / sizeof(drivers[0]); i++) {
		snprintf(path, sizeof(path), "/sys/bus/platform/drivers/%s", drivers[i]);
		if (access(path, F_OK) == 0)
			return true;
	}
	return false;
}

/*
 * Why netlink cannot serve here, now and later; NULL: it is a passing fault, as is silence of a
 * kernel that has answered before.
 */
static const char *refusal_text(const struct w1_netlink *netlink, int err)
{
	switch (err) {
	case -EPERM:
	case -EACCES:
		return "no right to it";
	case -EAFNOSUPPORT:
		return "this service may not open such sockets (RestrictAddressFamilies)";
	case -EPROTONOSUPPORT:
		return "this kernel has no connector (CONFIG_CONNECTOR)";
	case -ECONNREFUSED:
		return "the connector is in another network namespace";
	case -ETIMEDOUT:
		return netlink->answered ? NULL
		                         : "this kernel's w1 does not answer there (CONFIG_W1_CON)";
	case -EOPNOTSUPP:
		return "a driver here (ds1wm, omap_hdq) has no single slots";
	default:
		return NULL;
	}
}

static int serve_sysfs(struct w1_netlink *netlink, int err)
{
	char text[BUS_EVENT_TEXT];

	netlink->refused = true;
	snprintf(text, sizeof(text), "netlink refused: %s; served by files as target w1",
	         refusal_text(netlink, err));
	if (!netlink->told)
		bus_report(netlink->master.env, BUS_NOTE, err, text);
	netlink->told = true;
	return 0;
}

static int open_masters(struct link_master *base, char *why, size_t why_size)
{
	struct w1_netlink *netlink = (struct w1_netlink *)base;
	int n = w1_master.open(netlink->sysfs, why, why_size);

	netlink->count = netlink->seen_count = 0;
	netlink->refused = false;
	if (n)
		return n;
	/* owsd's own search finds devices; no thread would read the kernel's events of them */
	w1_master_deafen(netlink->sysfs);
	n = has_no_slots() ? -EOPNOTSUPP : w1_talk_open(&netlink->talk);
	if (!n)
		n = add_links(netlink);
	netlink->answered |= n > 0;
	if (netlink->count) {
		netlink->told = false;
		return 0;
	}
	w1_talk_close(&netlink->talk);
	if (refusal_text(netlink, n))
		return serve_sysfs(netlink, n);
	snprintf(why, why_size, "netlink: %s", n < 0 ? strerror(-n) : "no such master any more");
	return n < 0 ? n : -ENODEV;
}

static void close_masters(struct link_master *base)
{
	struct w1_netlink *netlink = (struct w1_netlink *)base;

	w1_talk_close(&netlink->talk);
	w1_master.close(netlink->sysfs);
	netlink->count = 0;
}

/* The same masters as target w1, whoever serves them. */
static int netlink_visible(struct link_master *base, uint64_t *mark)
{
	struct w1_netlink *netlink = (struct w1_netlink *)base;

	return w1_master.visible(netlink->sysfs, mark);
}

static unsigned netlink_channels(struct link_master *base)
{
	struct w1_netlink *netlink = (struct w1_netlink *)base;

	return netlink->refused ? w1_master.channels(netlink->sysfs) : netlink->count;
}

static struct link *netlink_channel(struct link_master *base, unsigned n)
{
	struct w1_netlink *netlink = (struct w1_netlink *)base;

	return netlink->refused ? w1_master.channel(netlink->sysfs, n) : &netlink->links[n].link;
}

static void netlink_master_cost(const struct link_master *base, struct link_master_cost *cost)
{
	*cost = (struct link_master_cost){
		.syscalls = ((const struct w1_netlink *)base)->talk.syscalls};
}

static const struct link_master_ops netlink_master = {
	.create = netlink_create,
	.open = open_masters,
	.grow = netlink_grow,
	.close = close_masters,
	.visible = netlink_visible,
	.channels = netlink_channels,
	.channel = netlink_channel,
	.cost = netlink_master_cost,
	.destroy = netlink_destroy,
	.slow = true,
};

/* --- The buses of scheme "w1": over netlink if the target says so, else over sysfs ----------- */

static const struct bus_ops netlink_bus = {
	.scheme = "w1",
	.summary = "1-Wire devices on the kernel's masters (netlink)",
	NATIVE_BUS_SLOTS,
};

static int netlink_bus_create(const char *where, const struct bus_env *env, struct bus **bus,
                              char *why, size_t why_size)
{
	if (is_netlink(where))
		return native_create(&netlink_bus, &netlink_master, where, env, bus, why, why_size);
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
