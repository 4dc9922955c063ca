/* SPDX-License-Identifier: MIT */
/* Parts of a transaction on a link, one by one, as a test writes them. */
#pragma once

#include "hal/wire/link.h"

/* 1: a chip is there, 0: none is; or an error. */
static inline int part_reset(struct link *link)
{
	const struct link_part part = {.reset = true};
	int err = link->ops->run(link, &part);

	return err == -EHOSTDOWN ? 0 : err ? err : 1;
}

static inline int part_write(struct link *link, const uint8_t *bytes, size_t n,
                             enum link_after after)
{
	const struct link_part part = {.out = bytes, .out_n = n, .after = after};

	return link->ops->run(link, &part);
}

static inline int part_read(struct link *link, uint8_t *bytes, size_t n)
{
	const struct link_part part = {.in = bytes, .in_n = n};

	return link->ops->run(link, &part);
}
