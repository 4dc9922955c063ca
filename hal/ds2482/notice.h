/* SPDX-License-Identifier: MIT */
/* What a master has to say of other programs that use its chips. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct link_master;

/* link_master_ops.trouble: at most one look a minute. */
void ds2482_trouble(struct link_master *master, bool failed, char *text, size_t size);
