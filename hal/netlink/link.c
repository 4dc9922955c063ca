/* SPDX-License-Identifier: MIT */
/*
 * What a transaction writes is kept until it reads or ends, and then goes to the kernel as one
 * request with its reset. There are no single slots: bit() reads a byte and gives its first slot;
 * to the chips that are asked so the seven behind it mean nothing.
 */
#include <errno.h>

#include "hal/netlink/link.h"
#include "hal/netlink/run.h"
#include "hal/netlink/search.h"

static struct w1_netlink_link *self(struct link *link)
{
	return (struct w1_netlink_link *)link;
}

static int flush(struct link *base)
{
	struct w1_netlink_link *link = self(base);

	return link->request.count ? w1_netlink_run(link, &link->request) : 0;
}

/* What the transaction before kept goes first. */
static int reset(struct link *base)
{
	struct w1_netlink_link *link = self(base);
	int err = flush(base);

	if (err)
		return err == -EHOSTDOWN ? 0 : err;
	link->sent = false;
	link->next_slot = -1;
	return w1_request_add(&link->request, W1_RESET, NULL, 0, NULL) ? -EIO : 1;
}

static int write_bytes(struct link *base, const uint8_t *data, size_t n, enum link_after after)
{
	struct w1_netlink_link *link = self(base);

	if (after == LINK_STRONG || link->sent)
		return -EOPNOTSUPP;
	if (n == 0)
		return 0;
	return w1_request_add(&link->request, W1_WRITE, data, n, NULL) ? -EIO : 0;
}

static int read_bytes(struct link *base, uint8_t *data, size_t n)
{
	struct w1_netlink_link *link = self(base);

	if (n == 0)
		return flush(base);
	if (w1_request_add(&link->request, W1_READ, NULL, n, data))
		return -EIO;
	return w1_netlink_run(link, &link->request);
}

static int bit(struct link *base, bool out, enum link_after after)
{
	struct w1_netlink_link *link = self(base);
	int slot = link->next_slot;
	uint8_t byte;

	if (!out || after == LINK_STRONG)
		return -EOPNOTSUPP;
	link->next_slot = -1;
	if (slot >= 0)
		return slot;
	int err = read_bytes(base, &byte, 1);
	return err ? err : byte & 1;
}

/* The kernel's driver sees to its chip; what is left to try is to ask again. */
static int recover(struct link *base, enum link_rung rung)
{
	switch (rung) {
	case LINK_BUS_RESET: {
		int err = reset(base);

		if (err > 0)
			err = flush(base);
		return err == -EHOSTDOWN ? 0 : err;
	}
	case LINK_CHIP_RESET:
	case LINK_POWER_CYCLE:
	case LINK_RUNGS:
		break;
	}
	return -EOPNOTSUPP;
}

static void cost(const struct link *base, struct link_cost *cost)
{
	*cost = ((const struct w1_netlink_link *)base)->cost;
}

const struct link_ops w1_netlink_link_ops = {
	.name = "w1 netlink",
	.reset = reset,
	.write = write_bytes,
	.read = read_bytes,
	.bit = bit,
	.search = w1_netlink_search,
	.verify = w1_netlink_verify,
	.flush = flush,
	.recover = recover,
	.cost = cost,
};
