/* SPDX-License-Identifier: MIT */
/*
 * A serial adapter as a master with one link: its port opened, proved, closed and opened again.
 *
 * Room hal/serial: serial adapters as links: DS2480B, and passive ones.
 */
#pragma once

#include "hal/base/rivals.h"
#include "hal/serial/known.h"
#include "hal/serial/port.h"
#include "hal/wire/link.h"

struct serial_master;

/* An adapter of a kind. */
struct serial_kind {
	const struct link_ops *link;
	struct link_facts facts;
	int64_t lag_ns; /* an answer is whole so long after what it answers was sent */
	/* The port was opened: 0, or an error, and why gets what answers in its place. */
	int (*begin)(struct serial_master *master, char *why, size_t why_size);
};

#define SERIAL_NAME 128

struct serial_master {
	struct link_master master;
	struct link link;
	const struct serial_kind *kind;
	struct serial_source source;
	struct serial_port *port; /* NULL: closed */
	char name[SERIAL_NAME];   /* of the port as it was opened last */
	struct link_cost cost;
	struct link_master_cost closed; /* of ports that were closed */
	uint64_t transfers;

	/* The DS2480B. */
	bool data_mode, strong, lost; /* lost: what the adapter does now is not known */

	/* Passive. */
	unsigned baud; /* the speed that is set */
	struct known_ids known;
};

static inline struct serial_master *serial_of(struct link *link)
{
	return (struct serial_master *)((char *)link - offsetof(struct serial_master, link));
}

int serial_create(const struct link_master_ops *ops, const struct serial_kind *kind,
                  const struct bus_env *env, const struct serial_source *source,
                  struct link_master **out);
/* Members of a struct link_master_ops. */
int serial_open(struct link_master *base, char *why, size_t why_size);
void serial_close(struct link_master *base);
int serial_visible(struct link_master *base, uint64_t *mark);
void serial_trouble(struct link_master *base, bool failed, char *text, size_t size);
unsigned serial_channels(struct link_master *base);
struct link *serial_channel(struct link_master *base, unsigned n);
void serial_master_cost(const struct link_master *base, struct link_master_cost *cost);
void serial_destroy(struct link_master *base);

/* For the kinds: wait for a time. 0 or -ECANCELED. */
int serial_wait(struct serial_master *master, int64_t ns);
/*
 * Write all, and read n bytes, not before the last one can have come. Their time on the line at
 * this speed, and some more, is the deadline: -ETIMEDOUT, and *got is how many came.
 */
int serial_exchange(struct serial_master *master, unsigned baud, const uint8_t *out, size_t out_n,
                    uint8_t *in, size_t n, size_t *got);
/* Read and forget until nothing has come for a while. */
int serial_settle(struct serial_master *master);
void serial_cost(const struct link *link, struct link_cost *cost);
