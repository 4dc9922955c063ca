/* SPDX-License-Identifier: MIT */
/*
 * What a transaction writes is kept until it reads or ends, and then goes to the kernel as one
 * request with its reset. There are no single slots: first_slot() reads a byte and returns the
 * first of its slots; to the chips that are asked so the seven behind it mean nothing.
 */
#include <errno.h>

#include "hal/netlink/link.h"
#include "hal/netlink/run.h"
#include "hal/netlink/search.h"

static struct w1_netlink_link *link_of(struct link *link)
{
	return (struct w1_netlink_link *)link;
}

static int send_kept(struct link *base)
{
	struct w1_netlink_link *link = link_of(base);

	return link->request.count ? w1_netlink_run(link, &link->request) : 0;
}

/* What the transaction before kept goes first. */
static int keep_reset(struct link *base)
{
	struct w1_netlink_link *link = link_of(base);
	int err = send_kept(base);

	if (err)
		return err == -EHOSTDOWN ? 0 : err;
	link->sent = false;
	link->next_slot = -1;
	return w1_request_add(&link->request, W1_RESET, NULL, 0, NULL) ? -EIO : 1;
}

static int netlink_write(struct link *base, const uint8_t *data, size_t n, enum link_after after)
{
	struct w1_netlink_link *link = link_of(base);

	if (after == LINK_STRONG || link->sent)
		return -EOPNOTSUPP;
	if (n == 0)
		return 0;
	return w1_request_add(&link->request, W1_WRITE, data, n, NULL) ? -EIO : 0;
}

static int netlink_read(struct link *base, uint8_t *data, size_t n)
{
	struct w1_netlink_link *link = link_of(base);

	if (n == 0)
		return send_kept(base);
	if (w1_request_add(&link->request, W1_READ, NULL, n, data))
		return -EIO;
	return w1_netlink_run(link, &link->request);
}

static int first_slot(struct link *base, bool out, enum link_after after)
{
	struct w1_netlink_link *link = link_of(base);
	int slot = link->next_slot;
	uint8_t byte;

	if (!out || after == LINK_STRONG)
		return -EOPNOTSUPP;
	link->next_slot = -1;
	if (slot >= 0)
		return slot;
	int err = netlink_read(base, &byte, 1);
	return err ? err : byte & 1;
}

/* The kernel's driver sees to its chip; what is left to try is to ask again. */
static int netlink_recover(struct link *base, enum link_rung rung)
{
	switch (rung) {
	case LINK_BUS_RESET: {
		int err = keep_reset(base);

		if (err > 0)
			err = send_kept(base);
		return err == -EHOSTDOWN ? 0 : err;
	}
	case LINK_CHIP_RESET:
	case LINK_POWER_CYCLE:
	case LINK_RUNGS:
		break;
	}
	return -EOPNOTSUPP;
}

static void netlink_cost(const struct link *base, struct link_cost *cost)
{
	*cost = ((const struct w1_netlink_link *)base)->cost;
}

const struct link_ops w1_netlink_link_ops = {
	.name = "w1 netlink",
	.reset = keep_reset,
	.write = netlink_write,
	.read = netlink_read,
	.bit = first_slot,
	.search = w1_netlink_search,
	.verify = w1_netlink_verify,
	.flush = send_kept,
	.recover = netlink_recover,
	.cost = netlink_cost,
};
