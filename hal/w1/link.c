/* SPDX-License-Identifier: MIT */
/*
 * The commands that the families' functions send, as far as attributes can stand for them. Each
 * is whole in one write: reset, Match ROM, the command; what is read then is its answer.
 */
#include <errno.h>
#include <string.h>

#include "hal/w1/w1.h"

#define MATCH_ROM 0x55
#define SKIP_ROM 0xcc
#define CONVERT_T 0x44

static int reset(struct link *base)
{
	struct w1_link *link = (struct w1_link *)base;

	link->wire = NULL;
	link->slave = NULL;
	link->length = 0;
	link->all = false;
	return 1;
}

static int to_all(struct w1_link *link, const uint8_t *bytes, size_t n)
{
	link->all = true;
	if (n == 2 && bytes[1] == CONVERT_T)
		w1_convert_all(link);
	return 0;
}

static int write_bytes(struct link *base, const uint8_t *bytes, size_t n, enum link_after after)
{
	struct w1_link *link = (struct w1_link *)base;

	if (n && bytes[0] == SKIP_ROM && !link->slave)
		return to_all(link, bytes, n);
	if (link->slave || n < 9 || bytes[0] != MATCH_ROM || n - 9 > sizeof(link->command))
		return -EOPNOTSUPP;
	link->slave = w1_slave_of(link->master, bytes + 1);
	link->length = n - 9;
	memcpy(link->command, bytes + 9, link->length);
	const struct w1_driver *driver = w1_driver_of(link->master, link->slave->rom);
	link->wire = driver ? driver->wire : &w1_rw_wire;
	/* Drivers know when their chips need the pull-up; raw access has none. */
	if (after == LINK_STRONG && !driver)
		return -EOPNOTSUPP;
	return link->wire ? link->wire->command(link) : -EOPNOTSUPP;
}

static int read_bytes(struct link *base, uint8_t *bytes, size_t n)
{
	struct w1_link *link = (struct w1_link *)base;

	return link->wire ? link->wire->answer(link, bytes, n) : -EOPNOTSUPP;
}

static int bit(struct link *base, bool out, enum link_after after)
{
	struct w1_link *link = (struct w1_link *)base;

	(void)out;
	(void)after;
	/* Read Power Supply of all: the driver sees to those that are fed by the wire. */
	if (link->all)
		return 1;
	return link->wire && link->wire->bit ? link->wire->bit(link) : -EOPNOTSUPP;
}

const struct link_ops w1_link_ops = {
	.name = "w1",
	.reset = reset,
	.write = write_bytes,
	.read = read_bytes,
	.bit = bit,
};
