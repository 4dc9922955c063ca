/* SPDX-License-Identifier: MIT */
/* The attribute "rw", which slaves without a driver have: a write selects, a read goes on. */
#include <errno.h>

#include "hal/w1/w1.h"

static int command(struct w1_link *link)
{
	return w1_slave_write(link->master, link->slave->rom, "rw", link->command, link->length);
}

static int answer(struct w1_link *link, uint8_t *bytes, size_t n)
{
	int err = w1_slave_read(link->master, link->slave->rom, "rw", bytes, n);

	return err < 0 ? err : (size_t)err == n ? 0 : -EIO;
}

const struct w1_wire w1_rw_wire = {.command = command, .answer = answer};
