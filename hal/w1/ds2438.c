/* SPDX-License-Identifier: MIT */
/*
 * DS2438: reading `temperature`, `vad` and `vdd` makes the chip convert and leaves the result in
 * page 0, where the family's functions look for it.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/ds2438.h"
#include "hal/owfs/path.h"
#include "hal/w1/w1.h"

#define RECALL 0xb8
#define READ_SCRATCHPAD 0xbe
#define WRITE_SCRATCHPAD 0x4e
#define COPY_SCRATCHPAD 0x48
#define CONVERT_T 0x44
#define CONVERT_V 0xb4
#define WRITTEN 0x80 /* in w1_slave.config: to the scratchpad, until it is recalled */

static int page(struct w1_link *link, unsigned n, uint8_t bytes[8])
{
	int err = n > 1 ? -ENOENT
	                : w1_slave_read(link->master, link->slave->rom, n ? "page1" : "page0",
	                                bytes, 8);

	return err < 0 ? err : err == 8 ? 0 : -EIO;
}

/* Of the configuration the driver can change what it measures, not the accumulator's bits. */
static int copy(struct w1_link *link)
{
	uint8_t bytes[8], on;
	int err = page(link, 0, bytes);

	if (err)
		return err;
	uint8_t changed = (bytes[0] ^ link->slave->config) & 0x0f;
	link->slave->config &= 0x0f;
	if (changed & ~(DS2438_IAD | DS2438_AD))
		return -EOPNOTSUPP;
	on = link->slave->config & DS2438_IAD;
	return changed & DS2438_IAD ? w1_slave_write(link->master, link->slave->rom, "iad", &on, 1)
	                            : 0;
}

static int command(struct w1_link *link)
{
	const uint8_t *bytes = link->command, *rom = link->slave->rom;

	switch (bytes[0]) {
	case RECALL:
		if (bytes[1] == 0)
			link->slave->config &= 0x0f;
		return 0;
	case READ_SCRATCHPAD:
		return 0;
	case WRITE_SCRATCHPAD:
		if (bytes[1] || link->length != 3)
			return -EOPNOTSUPP;
		link->slave->config = (bytes[2] & 0x0f) | WRITTEN;
		return 0;
	case COPY_SCRATCHPAD:
		return bytes[1] ? -EOPNOTSUPP : copy(link);
	case CONVERT_T:
		link->slave->config &= 0x0f;
		return w1_slave_text(link->master, rom, "temperature");
	case CONVERT_V:
		link->slave->config &= 0x0f;
		return w1_slave_text(link->master, rom,
		                     link->slave->config & DS2438_AD ? "vdd" : "vad");
	}
	return -EOPNOTSUPP;
}

static int answer(struct w1_link *link, uint8_t *bytes, size_t n)
{
	int err;

	if (link->command[0] != READ_SCRATCHPAD || n != 9)
		return -EOPNOTSUPP;
	err = page(link, link->command[1], bytes);
	if (err)
		return err;
	if (link->command[1] == 0 && link->slave->config & WRITTEN)
		bytes[0] = (uint8_t)((bytes[0] & 0xf0) | (link->slave->config & 0x0f));
	else if (link->command[1] == 0)
		link->slave->config = bytes[0] & 0x0f;
	bytes[8] = rom_crc8(bytes, 8);
	return 0;
}

const struct w1_wire w1_ds2438_wire = {.command = command, .answer = answer};
