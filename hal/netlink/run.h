/* SPDX-License-Identifier: MIT */
/*
 * The target "w1:netlink": the kernel's 1-Wire masters as links, over the netlink connector. The
 * parts, from the top down:
 *
 *   master.c  the target "w1" of both; the masters there are, and those that come later; sysfs in
 *             place of a refused netlink; one master as a link: each part is one request
 *   search.c  searches, made of slots; their direction is chosen before
 *   run.c     a request of a link, and the errno that its reply means
 *   talk.c    the socket; requests of several commands and their replies
 *
 * Wire format and what replies mean: the kernel's Documentation/w1/w1-netlink.rst, and seen on
 * Linux 6.1. The kernel carries out the commands of one request with the master's bus locked, so
 * that neither its own search nor another program comes between.
 *
 * Room hal/netlink: the masters of the kernel, by netlink.
 */
#pragma once

#include "hal/native/limits.h"
#include "hal/netlink/talk.h"
#include "hal/w1/master.h"
#include "hal/wire/device.h"

struct w1_netlink;

/* A device that was found, for searches to guess with. */
struct w1_seen {
	uint8_t rom[8];
	uint8_t channel;
};

struct w1_netlink_link {
	struct link link;
	struct w1_netlink *netlink;
	uint32_t number; /* of w1_bus_masterN */
	int next_slot;   /* verify() has read it already; -1: not */
	unsigned alarm_searches;
	struct link_cost cost;
};

struct w1_netlink {
	struct link_master master;
	struct w1_talk talk;
	unsigned count;
	struct w1_netlink_link links[NATIVE_CHANNELS];
	unsigned seen_count;
	struct w1_seen seen[DEVICE_MAX];
	struct link_master *sysfs; /* target w1's, in case netlink is refused */
	bool refused, told;
	bool answered; /* once at least */
};

/*
 * Runs a request. -EHOSTDOWN no chip answered its reset,
 * -EIO also a command that the kernel refused; else as w1_request_run.
 */
int w1_netlink_run(struct w1_netlink_link *link, struct w1_request *request);
