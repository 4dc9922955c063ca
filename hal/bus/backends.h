/* SPDX-License-Identifier: MIT */
/* The backend that a target names. */
#pragma once

#include "hal/bus/bus.h"

/*
 * The backend that a target means: that of its scheme, else owserver. *where, unless it is NULL:
 * the text after the scheme. Returns NULL: this program has none of it.
 */
const struct bus_ops *bus_backend(const char *target, const char **where);
/* Have its values the age of the chip's, by a cache of owsd's own? */
bool bus_caches(const char *target);

/*
 * Find the backend of a target ("owserver:localhost:4304", "null:") and create the bus. Bare
 * `host`, `host:port` and `[v6]:port` mean owserver, and so does an empty target (localhost). A
 * word that is a scheme means the scheme, with or without a colon. Returns as bus_ops.create;
 * -EPROTONOSUPPORT when no backend of this program has the scheme (why names its schemes, or for
 * sim the program that has it). why is the end of a message that names the target before.
 */
int bus_create(const char *target, const struct bus_env *env, struct bus **bus, char *why,
               size_t why_size);
