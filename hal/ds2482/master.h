/* SPDX-License-Identifier: MIT */
/* A master: the chips of an adapter, opened, closed and opened again. */
#pragma once

#include <stddef.h>
#include <stdint.h>

struct bus_env;
struct ds2482_source;
struct link;
struct link_master;
struct link_master_cost;
struct link_master_ops;

/*
 * Make a master; it owns source.ctx from then on. where is ":0x18.3", ":0x18" or "" (all chips).
 * 0, -EINVAL with the reason in why, -ENOMEM.
 */
int ds2482_create(const struct link_master_ops *ops, const struct bus_env *env,
                  const struct ds2482_source *source, const char *where,
                  struct link_master **master, char *why, size_t why_size);
int ds2482_open(struct link_master *master, char *why, size_t why_size);
int ds2482_grow(struct link_master *master, char *why, size_t why_size);
void ds2482_close(struct link_master *master);
int ds2482_visible(struct link_master *master, uint64_t *mark);
unsigned ds2482_channels(struct link_master *master);
struct link *ds2482_channel(struct link_master *master, unsigned n);
void ds2482_cost(const struct link_master *master, struct link_master_cost *cost);
void ds2482_destroy(struct link_master *master);
