/* SPDX-License-Identifier: MIT */
/*
 * A serial adapter as a master with one link: its port opened, proved, closed and opened again.
 *
 * Room hal/serial: serial adapters as links: DS2480B, and passive ones.
 */
#pragma once

#include "hal/serial/known.h"
#include "hal/serial/port.h"
#include "hal/wire/adapter.h"

struct serial_master;

/* An adapter of a kind. */
struct serial_kind {
	struct adapter_kind adapter;
	int64_t lag_ns; /* an answer is whole so long after what it answers was sent */
	/* The port was opened: 0, or an error, and why gets what answers in its place. */
	int (*begin)(struct serial_master *master, char *why, size_t why_size);
};

struct serial_master {
	struct adapter adapter;
	const struct serial_kind *kind;
	struct serial_source source;
	struct serial_port *port; /* while the adapter is open */

	unsigned baud;          /* the speed that is set; 0: not known */
	bool data_mode;         /* of a DS2480B */
	struct known_ids known; /* of a passive adapter's searches */
};

static inline struct serial_master *serial_of(struct adapter *adapter)
{
	return (struct serial_master *)adapter;
}

int serial_create(const struct link_master_ops *ops, const struct serial_kind *kind,
                  const struct bus_env *env, const struct serial_source *source,
                  struct link_master **out);
/* Members of a struct link_master_ops. */
int serial_open(struct link_master *base, char *why, size_t why_size);
void serial_close(struct link_master *base);
int serial_visible(struct link_master *base, uint64_t *mark);
void serial_destroy(struct link_master *base);
#define SERIAL_MASTER_SLOTS \
	.open = serial_open, .close = serial_close, .visible = serial_visible, \
	.destroy = serial_destroy, ADAPTER_MASTER_SLOTS

/* For the kinds. -ENOTTY: the port cannot have this speed. */
int serial_speed(struct serial_master *master, unsigned baud);
/*
 * Write all, and read n bytes, not before the last one can have come. Their time on
 * the line at this speed, and some more, is the deadline: -ETIMEDOUT, and *got is how many came.
 */
int serial_exchange(struct serial_master *master, unsigned baud, const uint8_t *out, size_t out_n,
                    uint8_t *in, size_t n, size_t *got);
/* Read and forget until nothing has come for a while. */
int serial_settle(struct serial_master *master);
