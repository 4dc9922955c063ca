/* SPDX-License-Identifier: MIT */
/*
 * DS2436 (data sheet, "Battery ID/Monitor Chip"): temperature, voltage, a counter of cycles, and
 * three pages of memory behind scratchpads.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/families.h"

enum { TB = 0x01, NVB = 0x02, LOCK = 0x04, ADB = 0x08 }; /* status, at 62h */
enum { CELSIUS = 0x60, STATUS = 0x62, VOLTAGE = 0x77, CYCLES = 0x82, END = 0x84 };
enum { NV1, NV2, SRAM, PAGES };
enum { TEMPERATURE, VOLT }; /* inputs */

/* A conversion: 10 ms at most. A copy into the EEPROM: 2 to 5 ms. */
#define CONVERSION_NS (10 * NS_PER_MS)
#define COPY_NS (5 * NS_PER_MS)

static const uint8_t page_size[PAGES] = {24, 8, 8};

struct ds2436 {
	uint8_t scratchpad[PAGES][32], stored[PAGES][32], registers[END - CELSIUS];
	uint8_t work; /* the code of the command that runs */
};

static uint8_t *at(struct sim_slave *slave, unsigned address)
{
	return &sim_state(slave, ds2436)->registers[address - CELSIUS];
}

/* The byte of a scratchpad; NULL: there is none at this address. */
static uint8_t *scratch(struct sim_slave *slave, unsigned address)
{
	unsigned page = address / 32;

	if (page >= PAGES || address % 32 >= page_size[page])
		return NULL;
	return &sim_state(slave, ds2436)->scratchpad[page][address % 32];
}

static void ds2436_power_on(struct sim_slave *slave)
{
	struct ds2436 *s = slave->state;

	memset(s->stored[SRAM], 0, sizeof(s->stored[SRAM]));
	memcpy(s->scratchpad, s->stored, sizeof(s->scratchpad));
	memset(at(slave, CELSIUS), 0, 2);
	*at(slave, STATUS) &= LOCK;
	memset(at(slave, VOLTAGE), 0, 2);
	s->work = 0;
}

static void ds2436_put16(uint8_t *to, int value)
{
	to[0] = (uint8_t)value;
	to[1] = (uint8_t)(value >> 8);
}

static void ds2436_count(struct sim_slave *slave)
{
	uint8_t *cycles = at(slave, CYCLES);
	int n = cycles[0] | cycles[1] << 8;

	if (n < 0xFFFF)
		ds2436_put16(cycles, n + 1);
}

static void ds2436_worked(struct sim_slave *slave)
{
	struct ds2436 *s = slave->state;
	int64_t volt = sim_round(sim_input_now(slave, VOLT) * 100);

	switch (s->work) {
	case 0xD2: /* 13 bits of 0.03125 degrees, left-aligned */
		ds2436_put16(at(slave, CELSIUS),
		             (int)sim_round(sim_input_now(slave, TEMPERATURE) * 32) * 8);
		slave->conversions++;
		break;
	case 0xB4: /* 10 bits of 10 mV */
		ds2436_put16(at(slave, VOLTAGE), volt < 0 ? 0 : volt > 1023 ? 1023 : (int)volt);
		slave->conversions++;
		break;
	case 0x22:
		memcpy(s->stored[NV1], s->scratchpad[NV1], page_size[NV1]);
		break;
	case 0x25:
		memcpy(s->stored[NV2], s->scratchpad[NV2], page_size[NV2]);
		break;
	case 0x43:
		*at(slave, STATUS) |= LOCK;
		break;
	case 0x44:
		*at(slave, STATUS) &= (uint8_t)~LOCK;
		break;
	case 0xB8:
		ds2436_put16(at(slave, CYCLES), 0);
		break;
	case 0xB5:
		ds2436_count(slave);
		break;
	default:
		break;
	}
	s->work = 0;
	*at(slave, STATUS) &= LOCK;
}

static void work(struct sim_slave *slave, uint8_t flag, int64_t takes)
{
	if (!slave->busy) {
		sim_state(slave, ds2436)->work = slave->function->code;
		*at(slave, STATUS) |= flag;
		sim_work(slave, takes);
	}
	sim_end(slave);
}

static void ds2436_convert(struct sim_slave *slave)
{
	work(slave, slave->function->code == 0xD2 ? TB : ADB, CONVERSION_NS);
}

static void change(struct sim_slave *slave)
{
	work(slave, NVB, COPY_NS);
}

static void copy_locked(struct sim_slave *slave)
{
	if (*at(slave, STATUS) & LOCK)
		sim_end(slave);
	else
		change(slave);
}

static void copy_sram(struct sim_slave *slave)
{
	struct ds2436 *s = slave->state;

	memcpy(s->stored[SRAM], s->scratchpad[SRAM], page_size[SRAM]);
	sim_end(slave);
}

static void ds2436_recall(struct sim_slave *slave)
{
	struct ds2436 *s = slave->state;
	unsigned page = slave->function->code == 0x71   ? NV1
	                : slave->function->code == 0x77 ? NV2
	                                                : SRAM;

	memcpy(s->scratchpad[page], s->stored[page], page_size[page]);
	sim_end(slave);
}

/* Where there is nothing the line stays high. */
static void ds2436_read_scratchpad(struct sim_slave *slave)
{
	const uint8_t *byte = scratch(slave, slave->address);

	slave->address++;
	sim_send_byte(slave, byte ? *byte : 0xFF);
}

static void ds2436_write_scratchpad(struct sim_slave *slave, uint8_t byte)
{
	uint8_t *to = scratch(slave, slave->address);

	slave->address++;
	if (to)
		*to = byte;
}

static void read_registers(struct sim_slave *slave)
{
	unsigned address = slave->address;
	bool there = (address >= CELSIUS && address < CELSIUS + 4) ||
	             (address >= VOLTAGE && address < VOLTAGE + 2) ||
	             (address >= CYCLES - 2 && address < END);

	slave->address++;
	sim_send_byte(slave, there ? *at(slave, address) : 0xFF);
}

static const struct sim_function functions[] = {
	{.code = 0x11, .takes = 1, .start = ds2436_read_scratchpad, .next = ds2436_read_scratchpad},
	{.code = 0x17, .takes = 1, .byte = ds2436_write_scratchpad},
	{.code = 0x22, .start = copy_locked},
	{.code = 0x25, .start = change},
	{.code = 0x28, .start = copy_sram},
	{.code = 0x71, .start = ds2436_recall},
	{.code = 0x77, .start = ds2436_recall},
	{.code = 0x7A, .start = ds2436_recall},
	{.code = 0x43, .start = change}, /* Lock, Unlock NV1 */
	{.code = 0x44, .start = change},
	{.code = 0xB2, .takes = 1, .start = read_registers, .next = read_registers},
	{.code = 0xB8, .start = change}, /* Reset, Increment Cycle Counter */
	{.code = 0xB5, .start = change},
	{.code = 0xB4, .start = ds2436_convert}, /* Convert V, Convert T */
	{.code = 0xD2, .start = ds2436_convert},
	{0},
};

static const struct sim_input inputs[] = {
	[TEMPERATURE] = {SIM_TEMPERATURE_INPUT},
	[VOLT] = {.name = "volt", .start = 5, .least = 2.4, .most = 10},
	{0},
};

const struct sim_family sim_ds2436 = {
	.name = "DS2436",
	.code = 0x1B,
	.state_size = sizeof(struct ds2436),
	.functions = functions,
	.inputs = inputs,
	.power_on = ds2436_power_on,
	.worked = ds2436_worked,
	SIM_MEMORY(ds2436, stored, 64), /* the EEPROM is recalled at power-on */
};
