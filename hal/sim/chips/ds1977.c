/* SPDX-License-Identifier: MIT */
/*
 * DS1977 (data sheet, "Password-Protected 32KB EEPROM iButton"): EEPROM in pages of 64 bytes, which
 * a password for reading and one for all can protect. The wire feeds it: reading and writing need a
 * strong pull-up. A read ends with its page, where the chip would go on after another pull-up.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/scratchpad.h"
#include "hal/sim/families.h"

enum { READ_PASSWORD = 0x7FC0, FULL_PASSWORD = 0x7FC8, PASSWORD_CONTROL = 0x7FD0 };
enum { PAGE = 64, LENGTH = 8, ENABLED = 0xAA, VERSION = 0x01 };
enum { COPY = 0x99, READ = 0x69, VERIFY = 0xC3 };

/* tSPUR: 5 ms to read a page or to compare, 10 ms to write. */
#define READ_NS (5 * NS_PER_MS)

struct ds1977 {
	struct sim_scratchpad memory; /* first */
	bool copying;                 /* the work under way is a copy */
};

static const struct sim_scratchpad_kind kind = {
	.size = PASSWORD_CONTROL + 1,
	.writable = PASSWORD_CONTROL + 1,
	.page = PAGE,
	.copy_ns = 10 * NS_PER_MS,
	.to_end = true,
};

/* Does the password that came equal the one at this address? */
static bool equals(struct sim_slave *slave, unsigned at)
{
	const uint8_t *password = slave->taken + slave->function->takes - LENGTH;

	return memcmp(password, sim_state(slave, ds1977)->memory.memory + at, LENGTH) == 0;
}

static bool accepted(struct sim_slave *slave)
{
	if (slave->function->code == VERIFY)
		return (slave->address == READ_PASSWORD || slave->address == FULL_PASSWORD) &&
		       equals(slave, slave->address);
	if (sim_state(slave, ds1977)->memory.memory[PASSWORD_CONTROL] != ENABLED)
		return true;
	return equals(slave, FULL_PASSWORD) ||
	       (slave->function->code == READ && equals(slave, READ_PASSWORD));
}

static void take_password(struct sim_slave *slave)
{
	struct ds1977 *s = slave->state;

	s->copying = slave->function->code == COPY;
	if (!accepted(slave)) {
		sim_end(slave);
	} else if (s->copying) {
		sim_scratchpad_copy(slave);
	} else {
		slave->got = 1;
		sim_work(slave, READ_NS);
	}
}

/* Send the byte at the address; one of a password reads FFh. At the end of a page the checksum. */
static void ds1977_send(struct sim_slave *slave)
{
	struct ds1977 *s = slave->state;
	uint8_t byte = 0xFF;

	if (slave->address >= kind.size ||
	    (slave->address % PAGE == 0 && slave->mode == SIM_SEND)) {
		sim_end(slave);
		return;
	}
	if (slave->address < READ_PASSWORD || slave->address >= PASSWORD_CONTROL)
		byte = s->memory.memory[slave->address];
	sim_send_next(slave, byte, PAGE);
}

static void ds1977_worked(struct sim_slave *slave)
{
	if (sim_state(slave, ds1977)->copying)
		sim_scratchpad_worked(slave);
	else if (slave->function && slave->function->code == READ)
		ds1977_send(slave);
}

static void send_version(struct sim_slave *slave)
{
	static const uint8_t version[2] = {VERSION, VERSION};

	if (slave->address == 0)
		sim_send(slave, version, sizeof(version));
	else
		sim_end(slave);
}

#define PROTECTED(number, bytes) \
	.code = (number), .takes = (bytes) + LENGTH, .unchecked = LENGTH, .start = take_password
static const struct sim_function functions[] = {
	{.code = 0x0F, .takes = 2, .start = sim_scratchpad_target, .byte = sim_scratchpad_write},
	{.code = 0xAA, .start = sim_scratchpad_read},
	{PROTECTED(COPY, 3)},
	{PROTECTED(READ, 2), .next = ds1977_send},
	{PROTECTED(VERIFY, 2)},
	{.code = 0xCC, .takes = 2, .start = send_version},
	{0},
};

const struct sim_family sim_ds1977 = {
	.name = "DS1977",
	.code = 0x37,
	.overdrive = true,
	.resume = true,
	.starves = true,
	.state_size = sizeof(struct ds1977),
	.functions = functions,
	.kind = &kind,
	.power_on = sim_scratchpad_power_on,
	.bit = sim_scratchpad_bit,
	.worked = ds1977_worked,
	SIM_MEMORY(ds1977, memory.memory, PASSWORD_CONTROL + 1),
};
