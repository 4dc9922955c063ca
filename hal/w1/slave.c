/* SPDX-License-Identifier: MIT */
/* The table of slaves; an attribute of one as bytes, as text, as a number. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/w1/slave.h"

struct w1_slave *w1_slave_of(struct w1_slaves *slaves, const uint8_t rom[8])
{
	for (unsigned i = 0; i < slaves->count; i++)
		if (memcmp(slaves->slave[i].rom, rom, 7) == 0)
			return &slaves->slave[i];
	/* The table is full, also with slaves that are gone: forget all; they are read again. */
	if (slaves->count == DEVICE_MAX)
		slaves->count = 0;
	struct w1_slave *slave = &slaves->slave[slaves->count++];
	*slave = (struct w1_slave){.tree = slaves->tree};
	memcpy(slave->rom, rom, 8);
	w1_name(rom, slave->name);
	return slave;
}

bool w1_slave_has(const struct w1_slave *slave, const char *name)
{
	return w1_exists(slave->tree, slave->name, name);
}

int w1_slave_read(struct w1_slave *slave, const char *name, unsigned at, void *data, size_t n)
{
	int got = w1_read(slave->tree, slave->name, name, at, data, n);
	return got < 0 ? got : (size_t)got == n ? 0 : -EIO;
}

int w1_slave_write(struct w1_slave *slave, const char *name, unsigned at, const void *data,
                   size_t n)
{
	return w1_write(slave->tree, slave->name, name, at, data, n);
}

int w1_slave_text(struct w1_slave *slave, const char *name)
{
	char *text = slave->tree->text;
	int n = w1_read(slave->tree, slave->name, name, 0, text, W1_TEXT_MAX - 1);
	text[n > 0 ? n : 0] = '\0';
	return n < 0 ? n : n ? 0 : -EIO;
}

int w1_slave_number(struct w1_slave *slave, const char *name, long *number)
{
	int err = w1_slave_text(slave, name);
	char *end;

	if (err)
		return err;
	*number = strtol(slave->tree->text, &end, 10);
	return end == slave->tree->text ? -EIO : 0;
}
