/* SPDX-License-Identifier: MIT */
/* The keys Listen... of the driver block. */
#pragma once

#include "src/config/read/rio.h"

struct build;
struct listen_address;
struct option_value;

/* Where the owserver protocol is served, and to whom. */
void serve_build(struct build *build, const struct option_value *values);
/* Add the addresses of a Listen, which are room for LISTEN_MAX; reports errors at position. */
void serve_addresses(struct build *build, const char *text, struct rio_position position,
                     struct listen_address *all, unsigned *count);
/* The addresses of owsd -l in their place. 0 or -EINVAL. */
int serve_listens(struct build *build, const char *const *texts, unsigned count);
