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

static uint8_t *register_at(struct sim_slave *slave, unsigned address)
{
	return &sim_state(slave, ds2436)->registers[address - CELSIUS];
}

/* The byte of a scratchpad; NULL: there is none at this address. */
static uint8_t *scratchpad_at(struct sim_slave *slave, unsigned address)
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
	memset(register_at(slave, CELSIUS), 0, 2);
	*register_at(slave, STATUS) &= LOCK;
	memset(register_at(slave, VOLTAGE), 0, 2);
	s->work = 0;
}

static void ds2436_worked(struct sim_slave *slave)
{
	struct ds2436 *s = slave->state;

	switch (s->work) {
	case 0xD2: /* 13 bits of 0.03125 degrees, left-aligned */
		sim_put(register_at(slave, CELSIUS), 2,
		        sim_round(sim_input_now(slave, TEMPERATURE) * 32) * 8);
		slave->conversions++;
		break;
	case 0xB4: /* 10 bits of 10 mV */
		sim_put(register_at(slave, VOLTAGE), 2,
		        sim_within(sim_input_now(slave, VOLT) * 100, 0, 1023));
		slave->conversions++;
		break;
	case 0x22:
		memcpy(s->stored[NV1], s->scratchpad[NV1], page_size[NV1]);
		break;
	case 0x25:
		memcpy(s->stored[NV2], s->scratchpad[NV2], page_size[NV2]);
		break;
	case 0x43:
		*register_at(slave, STATUS) |= LOCK;
		break;
	case 0x44:
		*register_at(slave, STATUS) &= (uint8_t)~LOCK;
		break;
	case 0xB8:
		sim_put(register_at(slave, CYCLES), 2, 0);
		break;
	case 0xB5:
		sim_count_up(register_at(slave, CYCLES), 2);
		break;
	}
	s->work = 0;
	*register_at(slave, STATUS) &= LOCK;
}

static void ds2436_work(struct sim_slave *slave, uint8_t flag, int64_t takes)
{
	if (!slave->busy) {
		sim_state(slave, ds2436)->work = slave->function->code;
		*register_at(slave, STATUS) |= flag;
		sim_work(slave, takes);
	}
	sim_end(slave);
}

static void ds2436_convert(struct sim_slave *slave)
{
	ds2436_work(slave, slave->function->code == 0xD2 ? TB : ADB, CONVERSION_NS);
}

static void change_eeprom(struct sim_slave *slave)
{
	ds2436_work(slave, NVB, COPY_NS);
}

static void copy_locked(struct sim_slave *slave)
{
	if (*register_at(slave, STATUS) & LOCK)
		sim_end(slave);
	else
		change_eeprom(slave);
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
	const uint8_t *byte = scratchpad_at(slave, slave->address++);

	sim_send_byte(slave, byte ? *byte : 0xFF);
}

static void ds2436_write_scratchpad(struct sim_slave *slave, uint8_t byte)
{
	uint8_t *to = scratchpad_at(slave, slave->address++);

	if (to)
		*to = byte;
}

static void ds2436_read_registers(struct sim_slave *slave)
{
	unsigned address = slave->address++;
	bool is_register = (address >= CELSIUS && address < CELSIUS + 4) ||
	                   (address >= VOLTAGE && address < VOLTAGE + 2) ||
	                   (address >= CYCLES - 2 && address < END);

	sim_send_byte(slave, is_register ? *register_at(slave, address) : 0xFF);
}

static const struct sim_function functions[] = {
	{.code = 0x11, .takes = 1, .start = ds2436_read_scratchpad, .next = ds2436_read_scratchpad},
	{.code = 0x17, .takes = 1, .byte = ds2436_write_scratchpad},
	{.code = 0x22, .start = copy_locked},
	{.code = 0x25, .start = change_eeprom},
	{.code = 0x28, .start = copy_sram},
	{.code = 0x71, .start = ds2436_recall},
	{.code = 0x77, .start = ds2436_recall},
	{.code = 0x7A, .start = ds2436_recall},
	{.code = 0x43, .start = change_eeprom}, /* Lock, Unlock NV1 */
	{.code = 0x44, .start = change_eeprom},
	{.code = 0xB2, .takes = 1, .start = ds2436_read_registers, .next = ds2436_read_registers},
	{.code = 0xB8, .start = change_eeprom}, /* Reset, Increment Cycle Counter */
	{.code = 0xB5, .start = change_eeprom},
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
