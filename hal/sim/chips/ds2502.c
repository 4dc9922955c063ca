/* SPDX-License-Identifier: MIT */
/*
 * DS2502 (data sheet 19-5076), and the same with contents from the factory, DS1982U: 1 kbit of
 * EPROM in four pages, and eight status bytes. They are programmed with 12 V, which nothing here
 * gives: the flow chart of a write runs, no bit changes.
 */
#include <string.h>

#include "hal/sim/families.h"

enum { MEMORY = 128, STATUS = 8, PAGE = 32, READ_MEMORY = 0xF0, READ_STATUS = 0xAA };
enum { WRITE_STATUS = 0x55 };

struct ds2502 {
	uint8_t memory[MEMORY], status[STATUS];
};

/* Status byte 7 is programmed at the factory. */
static void ds2502_create(struct sim_slave *slave)
{
	struct ds2502 *s = slave->state;

	memset(s, 0xFF, sizeof(struct ds2502));
	s->status[7] = 0;
}

/* Send the CRC8 of command and address. */
static void send_checksum(struct sim_slave *slave)
{
	sim_send_checked(slave, NULL, 0);
}

/*
 * Read Memory and Read Status send a checksum at the end, Read Data/Generate CRC after each page.
 */
static void ds2502_send(struct sim_slave *slave)
{
	struct ds2502 *s = slave->state;

	if (slave->function->code == READ_STATUS)
		sim_send_memory(slave, s->status, STATUS, STATUS);
	else
		sim_send_memory(slave, s->memory, MEMORY,
		                slave->function->code == READ_MEMORY ? MEMORY : PAGE);
}

/* Send the checksum; the pulse would come here; send the byte as it is; the next byte follows. */
static void ds2502_write(struct sim_slave *slave, uint8_t byte)
{
	struct ds2502 *s = slave->state;
	bool is_status = slave->function->code == WRITE_STATUS;

	(void)byte;
	if (slave->address >= (is_status ? STATUS : MEMORY))
		sim_end(slave);
	else
		sim_send_stored(slave,
		                is_status ? s->status[slave->address] : s->memory[slave->address]);
}

static const struct sim_function functions[] = {
	{.code = READ_MEMORY, .takes = 2, .start = send_checksum, .next = ds2502_send},
	{.code = READ_STATUS, .takes = 2, .start = send_checksum, .next = ds2502_send},
	/* Read Data/Generate 8-Bit CRC, Write Memory */
	{.code = 0xC3, .takes = 2, .start = send_checksum, .next = ds2502_send},
	{.code = 0x0F, .takes = 2, .byte = ds2502_write, .next = sim_receive},
	{.code = WRITE_STATUS, .takes = 2, .byte = ds2502_write, .next = sim_receive},
	{0},
};

#define EPROM(part, family) \
	.name = (part), .code = (family), .crc8 = true, .functions = functions, \
	.state_size = sizeof(struct ds2502), .create = ds2502_create, \
	SIM_MEMORY(ds2502, memory, sizeof(struct ds2502))

const struct sim_family sim_ds2502 = {EPROM("DS2502", 0x09)};
const struct sim_family sim_ds1982u = {EPROM("DS1982U", 0x89)};
