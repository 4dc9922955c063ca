/* SPDX-License-Identifier: MIT */
/*
 * What can go wrong on a wire between master and chips: bits turned over, chips that hear nothing
 * for the rest of a transaction, presence pulses that get lost. Laid on wire_link.h by
 * wire_net.trouble. Slots and resets are counted from trouble_none() on.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum trouble_kind {
	TROUBLE_NONE,
	TROUBLE_TURN,    /* the slots at, at + 1 ... of the bits of mask are turned over */
	TROUBLE_DEAF,    /* from slot at on no chip hears anything, until the next reset */
	TROUBLE_ABSENT,  /* reset at: the chips hear it, the master hears no presence */
	TROUBLE_FALSE,   /* reset at: the master hears a presence, the chips hear nothing more */
	TROUBLE_NOISE,   /* each slot is turned over, each presence lost, with this probability */
	TROUBLE_UNPLUG,  /* at slot at the first chip leaves the wire, for good */
	TROUBLE_SHORT,   /* from slot at on the wire is short, for good */
	TROUBLE_RESTART, /* the chips lose power at restart_ns, and every every_ns (0: once) */
};

struct trouble {
	enum trouble_kind kind;
	uint32_t at;
	uint8_t mask;
	double probability;
	uint64_t random;
	int64_t restart_ns, every_ns;
	/* Counted. */
	uint32_t slots, resets;
	bool due;           /* TROUBLE_UNPLUG, TROUBLE_SHORT: it is to happen now */
	bool deaf, written; /* no chip hears anything now; the master wrote the last slot */
	uint32_t turned;    /* by noise */
};

/* From here on nothing goes wrong; slots and resets are counted. */
void trouble_none(struct trouble *trouble);
/* A reset: do the chips hear it? */
bool trouble_heard(struct trouble *trouble);
/* ... and is this what the master hears, or its opposite? */
bool trouble_presence(struct trouble *trouble, bool presence);
/* A slot: is its bit turned over? Chips hear nothing while deaf. */
bool trouble_turns(struct trouble *trouble);
