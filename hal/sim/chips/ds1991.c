/* SPDX-License-Identifier: MIT */
/*
 * DS1991 (data sheet 012207) and DS1425: three subkeys, each of which a password protects, and a
 * scratchpad. A subkey is an identifier, a password, and 48 bytes of data.
 */
#include <string.h>

#include "hal/sim/families.h"

enum { SUBKEYS = 3, AREA = 64, FIELD = 8, PASSWORD = FIELD, DATA = 2 * FIELD, BLOCKS = 9 };
enum { WRITE_PASSWORD = 0x5A, WRITE_SUBKEY = 0x99, READ_SUBKEY = 0x66 };

struct ds1991 {
	uint8_t subkey[SUBKEYS][AREA], scratchpad[AREA];
	uint8_t in[3 * FIELD]; /* what came after the address */
	unsigned count;
	uint32_t noise; /* what a wrong password reads */
};

/* Block selector codes: all 64 bytes, identifier, password, six parts of the data. */
static const uint8_t selector[BLOCKS][FIELD] = {
	{0x56, 0x56, 0x7F, 0x51, 0x57, 0x5D, 0x5A, 0x7F},
	{0x9A, 0x9A, 0xB3, 0x9D, 0x64, 0x6E, 0x69, 0x4C},
	{0x9A, 0x9A, 0x4C, 0x62, 0x9B, 0x91, 0x69, 0x4C},
	{0x9A, 0x65, 0xB3, 0x62, 0x9B, 0x6E, 0x96, 0x4C},
	{0x6A, 0x6A, 0x43, 0x6D, 0x6B, 0x61, 0x66, 0x43},
	{0x95, 0x95, 0xBC, 0x92, 0x94, 0x9E, 0x99, 0xBC},
	{0x65, 0x9A, 0x4C, 0x9D, 0x64, 0x91, 0x69, 0xB3},
	{0x65, 0x65, 0xB3, 0x9D, 0x64, 0x6E, 0x96, 0xB3},
	{0x65, 0x65, 0x4C, 0x62, 0x9B, 0x91, 0x96, 0xB3},
};

/* Take the address: two bits for the area, six in it, then its complement. false: deaf. */
static bool take_address(struct sim_slave *slave, bool scratchpad, unsigned least, unsigned most)
{
	unsigned at = slave->taken[0] % AREA;

	sim_state(slave, ds1991)->count = 0;
	slave->address = slave->taken[0];
	if ((slave->taken[0] ^ slave->taken[1]) == 0xFF && at >= least && at <= most &&
	    (slave->taken[0] / AREA == SUBKEYS) == scratchpad)
		return true;
	sim_end(slave);
	return false;
}

static uint8_t *subkey(struct sim_slave *slave)
{
	return sim_state(slave, ds1991)->subkey[slave->taken[0] / AREA];
}

static void begin_scratchpad(struct sim_slave *slave)
{
	take_address(slave, true, 0, AREA - 1);
}

static void ds1991_write_scratchpad(struct sim_slave *slave, uint8_t byte)
{
	sim_state(slave, ds1991)->scratchpad[slave->address % AREA] = byte;
	if (++slave->address % AREA == 0)
		sim_end(slave);
}

static void ds1991_read_scratchpad(struct sim_slave *slave)
{
	unsigned at = slave->taken[0] % AREA;

	if (take_address(slave, true, 0, AREA - 1))
		sim_send(slave, sim_state(slave, ds1991)->scratchpad + at, AREA - at);
}

/* Keep a byte that came; true: there are n. */
static bool ds1991_take(struct sim_slave *slave, uint8_t byte, unsigned n)
{
	struct ds1991 *s = slave->state;

	s->in[s->count++] = byte;
	return s->count == n;
}

/* After selector and password: copy the block. */
static void ds1991_copy(struct sim_slave *slave)
{
	struct ds1991 *s = slave->state;
	const uint8_t *select = slave->taken + 2, *password = select + FIELD;
	unsigned block = 0, at = 0, size = AREA;

	if (!take_address(slave, false, 0, 0))
		return;
	sim_end(slave);
	while (block < BLOCKS && memcmp(selector[block], select, FIELD) != 0)
		block++;
	if (block == BLOCKS || memcmp(subkey(slave) + PASSWORD, password, FIELD) != 0)
		return;
	if (block > 0) {
		at = (block - 1) * FIELD;
		size = FIELD;
	}
	memcpy(subkey(slave) + at, s->scratchpad + at, size);
}

/* All that needs a password begins with the identifier. */
static void send_identifier(struct sim_slave *slave)
{
	bool whole = slave->function->code == WRITE_PASSWORD;

	if (take_address(slave, false, whole ? 0 : DATA, whole ? 0 : AREA - 1))
		sim_send(slave, subkey(slave), FIELD);
}

/* The identifier comes back, then a new one and a new password: the data are gone. */
static void write_password(struct sim_slave *slave, uint8_t byte)
{
	struct ds1991 *s = slave->state;

	if (ds1991_take(slave, byte, 3 * FIELD)) {
		memcpy(subkey(slave), s->in + FIELD, 2 * FIELD);
		memset(subkey(slave) + DATA, 0, AREA - DATA);
		sim_end(slave);
	} else if (s->count == FIELD && memcmp(s->in, subkey(slave), FIELD) != 0) {
		sim_end(slave);
	}
}

static void write_subkey(struct sim_slave *slave, uint8_t byte)
{
	struct ds1991 *s = slave->state;

	if (s->count == FIELD) {
		subkey(slave)[slave->address % AREA] = byte;
		if (++slave->address % AREA == 0)
			sim_end(slave);
	} else if (ds1991_take(slave, byte, FIELD) &&
	           memcmp(s->in, subkey(slave) + PASSWORD, FIELD) != 0) {
		sim_end(slave);
	}
}

/* The identifier was sent: receive the password. The data were sent: ones. */
static void next_of_read(struct sim_slave *slave)
{
	if (sim_state(slave, ds1991)->count == 0)
		sim_receive(slave);
}

/* After the password send the data; random bytes if it is wrong. */
static void read_subkey(struct sim_slave *slave, uint8_t byte)
{
	struct ds1991 *s = slave->state;
	unsigned at = slave->address % AREA;
	uint8_t out[AREA];

	if (!ds1991_take(slave, byte, FIELD))
		return;
	memcpy(out, subkey(slave), AREA);
	for (unsigned i = 0; memcmp(s->in, subkey(slave) + PASSWORD, FIELD) && i < AREA; i++) {
		s->noise = s->noise * 1664525 + 1013904223;
		out[i] = (uint8_t)(s->noise >> 24);
	}
	sim_send(slave, out + at, AREA - at);
}

#define PROTECTED(number, takes_byte) \
	.code = (number), .takes = 2, .start = send_identifier, .byte = (takes_byte)
static const struct sim_function functions[] = {
	{.code = 0x96, .takes = 2, .start = begin_scratchpad, .byte = ds1991_write_scratchpad},
	{.code = 0x69, .takes = 2, .start = ds1991_read_scratchpad},
	{.code = 0x3C, .takes = 2 + 2 * FIELD, .start = ds1991_copy},
	{PROTECTED(WRITE_PASSWORD, write_password), .next = sim_receive},
	{PROTECTED(WRITE_SUBKEY, write_subkey), .next = sim_receive},
	{PROTECTED(READ_SUBKEY, read_subkey), .next = next_of_read},
	{0},
};

#define MULTIKEY(part, family) \
	.name = (part), .code = (family), .functions = functions, \
	.state_size = sizeof(struct ds1991), SIM_MEMORY(ds1991, subkey, SUBKEYS * AREA)

const struct sim_family sim_ds1991 = {MULTIKEY("DS1991", 0x02)};
const struct sim_family sim_ds1425 = {MULTIKEY("DS1425", 0x82)};
