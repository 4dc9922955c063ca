/* SPDX-License-Identifier: MIT */
/*
 * An adapter with one wire, as a master and as its link: what the drivers of serial and USB
 * adapters share. A kind of adapter moves a piece of a transaction at a time. Here stand what a
 * transaction is made of, what follows an error, and which other program has the adapter.
 */
#pragma once

#include "hal/base/rivals.h"
#include "hal/wire/link.h"

struct adapter;

struct adapter_kind {
	const struct link_ops *link; /* its name, and ADAPTER_LINK_SLOTS */
	struct link_facts facts;
	size_t piece; /* bytes of pass() at most */
	/*
	 * Each returns an error of link.h. After one that does not say what the wire had, settle()
	 * is next: nothing of what was before is still to come then, and commands are heeded.
	 */
	int (*settle)(struct adapter *adapter);
	/*
	 * A reset, if it is asked for; bytes that are written, which have come back as they were;
	 * bytes that are read. Each may be left out.
	 */
	int (*pass)(struct adapter *adapter, bool reset, const uint8_t *out, size_t out_n,
	            uint8_t *in, size_t in_n);
	/* A byte (n is 8) or a slot (1), and what follows it: what came back, or an error. */
	int (*bits)(struct adapter *adapter, uint8_t bits, unsigned n, bool strong);
	/* As link_ops.path. */
	int (*path)(struct adapter *adapter, bool reset, uint8_t command, uint8_t rom[8],
	            uint8_t conflict[8]);
	/* Reset its chip and set it up. NULL: it has none. */
	int (*renew)(struct adapter *adapter);
};

#define ADAPTER_NAME 128

/* First member of a driver's own struct. */
struct adapter {
	struct link_master master;
	struct link link;
	const struct adapter_kind *kind;
	bool open;
	bool lost;   /* what it does now is not known: settle() before the next reset */
	bool strong; /* the strong pull-up may be on */
	struct link_cost cost;
	struct link_master_cost shared;
	char name[ADAPTER_NAME];  /* for messages, as it was opened last */
	const char *device;       /* its device file */
	const char *proc;         /* RIVALS_PROC: look who else has it open; NULL: nobody can */
	char rivals[RIVALS_TEXT]; /* as the last look found them */
	int64_t look_ns;          /* no error before is worth another one */
};

static inline struct adapter *adapter_of(struct link *link)
{
	return (struct adapter *)((char *)link - offsetof(struct adapter, link));
}

void adapter_init(struct adapter *adapter, const struct adapter_kind *kind,
                  const struct link_master_ops *ops, const struct bus_env *env);
/* It does not open: put before the reason which other program has it, if there is room. */
void adapter_accuse(struct adapter *adapter, char *why, size_t size);
/* Wait for a time. 0 or -ECANCELED. */
int adapter_wait(struct adapter *adapter, int64_t ns);

/* Members of a struct link_ops. */
int adapter_recover(struct link *link, enum link_rung rung);
int adapter_run(struct link *link, const struct link_part *part);
int adapter_slot(struct link *link, bool out, enum link_after after);
int adapter_path(struct link *link, bool reset, uint8_t command, uint8_t rom[8],
                 uint8_t conflict[8]);
void adapter_link_cost(const struct link *link, struct link_cost *cost);
#define ADAPTER_LINK_SLOTS \
	.recover = adapter_recover, .run = adapter_run, .slot = adapter_slot, \
	.path = adapter_path, .cost = adapter_link_cost

/* Members of a struct link_master_ops. */
void adapter_trouble(struct link_master *master, bool failed, char *text, size_t size);
unsigned adapter_channels(struct link_master *master);
struct link *adapter_channel(struct link_master *master, unsigned n);
void adapter_cost(const struct link_master *master, struct link_master_cost *cost);
#define ADAPTER_MASTER_SLOTS \
	.trouble = adapter_trouble, .channels = adapter_channels, .channel = adapter_channel, \
	.cost = adapter_cost
