/* SPDX-License-Identifier: MIT */
/*
 * Couplers (DS2409, data sheet 102199 "MicroLAN Coupler"): the branches behind them as links. Two
 * links stand in front of that of a wire. The trunk is the wire itself: it switches off what is on
 * before anything else. A branch switches itself on with Smart-On, coupler by coupler: then those
 * behind it have had their reset, and no other chip listens.
 *
 * At most one branch of a wire is on, and those that it is behind. A branch whose level is low is
 * not switched on (-ECOMM): a short of it would be one of the whole wire. -EBADMSG: a coupler did
 * not confirm.
 */
#pragma once

#include "hal/wire/link.h"

#define COUPLER_FAMILY 0x1f

enum coupler_branch { COUPLER_MAIN, COUPLER_AUX, COUPLER_BRANCHES };

/*
 * What device.own of a coupler holds, by branch: All Lines Off clears the event flags in the chip.
 */
struct coupler_seen {
	uint8_t events; /* since the user cleared them */
	uint8_t flags;  /* as last seen in the chip */
	uint8_t news; /* flags that the look before did not show; the bus clears each as it acts */
};

struct coupler;
struct branch {
	struct link link; /* first */
	struct coupler *coupler;
	uint8_t number; /* enum coupler_branch */
};

struct trunk {
	struct link link;                /* first */
	struct link_ops ops, branch_ops; /* those of the link of the wire, but for run */
	struct coupler *first;
	struct branch *on; /* the innermost that is on, or may be; NULL: none */
};

struct coupler {
	struct branch branch[COUPLER_BRANCHES];
	struct trunk *trunk;
	struct branch *parent; /* on which it is; NULL: on the trunk */
	struct coupler *next;  /* of the trunk */
	struct coupler_seen *seen;
	uint8_t rom[8];
	/*
	 * One of its branches may be on: it is switched off ahead of the n-th reset of its wire
	 * from now on; 0: none is. Of one that answers wrong n is large, as the others go on.
	 */
	uint8_t unsure;
};

/* Can a wire with this link have branches? It has to read between two writes. */
bool trunk_fits(const struct link *under);
/* Also when the wire's link has been made anew: the couplers stay, and are unsure. */
void trunk_set(struct trunk *trunk, struct link *under);
void coupler_add(struct trunk *trunk, struct branch *parent, struct coupler *coupler,
                 const uint8_t rom[8], struct coupler_seen *seen);
/*
 * Its status is read, for the sake of its events, while no branch of the wire is on. If it has no
 * news, its flags are old, and it is switched off, which clears them. 0 or an error.
 */
int coupler_look(struct coupler *coupler);
/* It is gone: nothing of it is switched any more. */
void coupler_remove(struct coupler *coupler);
/* Switch off what is on. 0 or an error. */
int trunk_rest(struct trunk *trunk);
