/* SPDX-License-Identifier: MIT */
/*
 * DS2720 (data sheet, "Efficient, Addressable Single-Cell Rechargeable Lithium Protection IC"):
 * registers, and two lockable blocks of four bytes of EEPROM, each with its shadow RAM.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/families.h"

enum { PROTECTION = 0x00, EEPROM_REGISTER = 0x07, SPECIAL = 0x08 };
enum { DE = 0x01, CE = 0x02, DC = 0x04, CC = 0x08, DOC = 0x10, UV = 0x40, OV = 0x80 };
enum { LOCK = 0x40, EEC = 0x80 }; /* below them, from bit 0 on, a flag for each locked block */
enum { OT = 0x01, PSF = 0x80 };
enum { BLOCKS = 2, BLOCK = 4 };
enum { OVERVOLTAGE, UNDERVOLTAGE, OVERCURRENT, OVERTEMPERATURE, PS }; /* inputs */

/* tEEC: 10 ms at most. */
#define COPY_NS (10 * NS_PER_MS)

struct ds2720 {
	uint8_t memory[256], eeprom[BLOCKS][BLOCK];
	uint8_t copied; /* the block that is being copied */
};

/* 20h and 30h. */
static unsigned block_at(unsigned block)
{
	return 0x20 + 0x10 * block;
}

/* The block in which the address lies; BLOCKS: none. */
static unsigned block_of(unsigned address)
{
	unsigned block = 0;

	while (block < BLOCKS && (address < block_at(block) || address >= block_at(block) + BLOCK))
		block++;
	return block;
}

static void ds2720_power_on(struct sim_slave *slave)
{
	struct ds2720 *s = slave->state;

	for (unsigned i = 0; i < BLOCKS; i++)
		memcpy(s->memory + block_at(i), s->eeprom[i], BLOCK);
	s->memory[PROTECTION] = CE | DE;
	s->memory[EEPROM_REGISTER] &= (1 << BLOCKS) - 1;
	s->memory[SPECIAL] = PSF;
}

/* A condition sets its flag, which stays; the flags and the enables decide on the FETs. */
static void ds2720_advance(struct sim_slave *slave)
{
	struct ds2720 *s = slave->state;
	static const uint8_t flags[] = {OV, UV, DOC};
	uint8_t *protection = &s->memory[PROTECTION];
	uint8_t *special = &s->memory[SPECIAL];

	for (unsigned i = 0; i < sizeof(flags); i++)
		if (sim_input_now(slave, i) >= 0.5)
			*protection |= flags[i];
	if (sim_input_now(slave, OVERTEMPERATURE) >= 0.5)
		*special |= OT;
	if (sim_input_now(slave, PS) < 0.5)
		*special &= (uint8_t)~PSF;
	*protection &= (uint8_t) ~(CC | DC);
	if ((*protection & CE) && !(*protection & OV) && !(*special & OT))
		*protection |= CC;
	if ((*protection & DE) && !(*protection & (UV | DOC)) && !(*special & OT))
		*protection |= DC;
}

static void ds2720_worked(struct sim_slave *slave)
{
	struct ds2720 *s = slave->state;

	memcpy(s->eeprom[s->copied], s->memory + block_at(s->copied), BLOCK);
	s->memory[EEPROM_REGISTER] &= (uint8_t)~EEC;
}

/* Any command other than the lock itself cancels the permission to lock. */
static void forget_lock(struct sim_slave *slave)
{
	sim_state(slave, ds2720)->memory[EEPROM_REGISTER] &= (uint8_t)~LOCK;
}

static void read_data(struct sim_slave *slave)
{
	struct ds2720 *s = slave->state;

	sim_send_memory(slave, s->memory, sizeof(s->memory), 0);
}

static void begin_read(struct sim_slave *slave)
{
	forget_lock(slave);
	read_data(slave);
}

static void ds2720_begin_write(struct sim_slave *slave)
{
	forget_lock(slave);
}

/*
 * What is read-only, reserved or locked stays unchanged; a write can clear flags but not set them.
 */
static void write_data(struct sim_slave *slave, uint8_t byte)
{
	struct ds2720 *s = slave->state;
	unsigned at = slave->address++, block = block_of(at);
	uint8_t *to = &s->memory[at % sizeof(s->memory)];

	if (at >= sizeof(s->memory))
		return;
	if (block < BLOCKS && !slave->busy && !(s->memory[EEPROM_REGISTER] >> block & 1))
		*to = byte;
	if (at == PROTECTION)
		*to = (uint8_t)((byte & (CE | DE)) | (*to & (byte | CC | DC) & ~(CE | DE)));
	if (at == EEPROM_REGISTER)
		*to |= byte & LOCK;
	if (at == SPECIAL)
		*to = byte & (OT | PSF);
	ds2720_advance(slave);
}

static void ds2720_copy(struct sim_slave *slave)
{
	struct ds2720 *s = slave->state;
	unsigned block = block_of(slave->address);

	forget_lock(slave);
	if (block < BLOCKS && !(s->memory[EEPROM_REGISTER] >> block & 1)) {
		s->copied = (uint8_t)block;
		s->memory[EEPROM_REGISTER] |= EEC;
		sim_work(slave, COPY_NS);
	}
	sim_end(slave);
}

static void ds2720_recall(struct sim_slave *slave)
{
	struct ds2720 *s = slave->state;
	unsigned block = block_of(slave->address);

	forget_lock(slave);
	if (block < BLOCKS)
		memcpy(s->memory + block_at(block), s->eeprom[block], BLOCK);
	sim_end(slave);
}

static void lock(struct sim_slave *slave)
{
	uint8_t *reg = &sim_state(slave, ds2720)->memory[EEPROM_REGISTER];
	unsigned block = block_of(slave->address);

	if (block < BLOCKS && (*reg & LOCK))
		*reg |= (uint8_t)(1 << block);
	forget_lock(slave);
	sim_end(slave);
}

static const struct sim_function functions[] = {
	{.code = 0x69, .takes = 1, .start = begin_read, .next = read_data}, /* Read Data */
	{.code = 0x6C, .takes = 1, .start = ds2720_begin_write, .byte = write_data},
	{.code = 0x48, .takes = 1, .start = ds2720_copy},
	{.code = 0xB8, .takes = 1, .start = ds2720_recall},
	{.code = 0x6A, .takes = 1, .start = lock},
	{0},
};

static const struct sim_input inputs[] = {
	[OVERVOLTAGE] = {SIM_CONDITION("overvoltage")},
	[UNDERVOLTAGE] = {SIM_CONDITION("undervoltage")},
	[OVERCURRENT] = {SIM_CONDITION("overcurrent")},
	[OVERTEMPERATURE] = {SIM_CONDITION("overtemperature")},
	[PS] = {SIM_PIN("ps")},
	{0},
};

const struct sim_family sim_ds2720 = {
	.name = "DS2720",
	.code = 0x31,
	.state_size = sizeof(struct ds2720),
	.functions = functions,
	.inputs = inputs,
	.power_on = ds2720_power_on,
	.worked = ds2720_worked,
	.advance = ds2720_advance,
	SIM_MEMORY(ds2720, eeprom, BLOCKS *BLOCK), /* it is recalled at power-on */
};
