/* SPDX-License-Identifier: MIT */
/*
 * A part is one request. There are no single slots: first_slot() reads a byte and returns the first
 * of its slots; to the chips that are asked so the seven behind it mean nothing.
 */
#include <errno.h>

#include "hal/netlink/link.h"
#include "hal/netlink/run.h"
#include "hal/netlink/search.h"

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

const struct link_ops w1_netlink_link_ops = {
	.name = "w1 netlink",
	.run = netlink_run,
	.slot = first_slot,
	.search = w1_netlink_search,
	.verify = w1_netlink_verify,
	.recover = netlink_recover,
	.cost = netlink_cost,
};
