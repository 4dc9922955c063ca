/* SPDX-License-Identifier: MIT */
/* A request of a link, and what became of it. */
#include <errno.h>

#include "hal/netlink/run.h"

/* The master did not know the link's number: -ENODEV if none of ours is left, else -EHOSTDOWN. */
static int error_of_lost(struct w1_netlink *netlink)
{
	uint32_t numbers[NATIVE_CHANNELS];
	int n = w1_talk_masters(&netlink->talk, numbers, NATIVE_CHANNELS);

	for (int i = 0; i < n; i++)
		for (unsigned k = 0; k < netlink->count; k++)
			if (netlink->links[k].number == numbers[i])
				return -EHOSTDOWN;
	return -ENODEV;
}

int w1_netlink_run(struct w1_netlink_link *link, struct w1_request *request)
{
	bool resets = request->count && request->command[0].code == W1_RESET;
	int err = w1_request_run(&link->netlink->talk, request);

	link->cost.resets += resets;
	if (err == -ENODEV)
		return error_of_lost(link->netlink);
	if (err)
		return err == -EPROTO ? -EIO : err;
	if (resets && request->command[0].status == W1_STATUS_NOBODY)
		return -EHOSTDOWN;
	for (unsigned i = 0; i < request->count; i++)
		if (request->command[i].status)
			return -EIO;
	return 0;
}
