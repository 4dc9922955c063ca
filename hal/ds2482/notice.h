/* SPDX-License-Identifier: MIT */
/* What a master has to say of other programs that use its chips. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct link_master;

/* link_master_ops.notice: at most one look a minute, each program once. */
bool ds2482_notice(struct link_master *master, char *text, size_t size);
