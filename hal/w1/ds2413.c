/* SPDX-License-Identifier: MIT */
/* DS2413: some kernels give its whole byte, some the lower half; they have compared the two. */
#include <errno.h>

#include "hal/w1/w1.h"

#define READ_PIO 0xf5
#define WRITE_PIO 0x5a
#define CONFIRMED 0xaa

static int command(struct w1_link *link)
{
	if (link->command[0] == WRITE_PIO && link->length == 3)
		return w1_slave_write(link->master, link->slave->rom, "output", &link->command[1],
		                      1);
	return link->command[0] == READ_PIO ? 0 : -EOPNOTSUPP;
}

static int answer(struct w1_link *link, uint8_t *bytes, size_t n)
{
	uint8_t state = 0;
	int err = w1_slave_read(link->master, link->slave->rom, "state", &state, 1);

	if (err != 1)
		return err < 0 ? err : -EIO;
	state = (uint8_t)((state & 0xf) | (~state & 0xf) << 4);
	for (size_t i = 0; i < n; i++)
		bytes[i] = link->command[0] == WRITE_PIO && i == 0 ? CONFIRMED : state;
	return 0;
}

const struct w1_wire w1_ds2413_wire = {.command = command, .answer = answer};
