/* SPDX-License-Identifier: MIT */
/* The simulated bridge chips: registers, commands, and 1-Wire operations run by the clock. */
#include <string.h>

#include "hal/sim/chip.h"

#define US 1000

/* Command codes and read pointer codes. */
enum {
	DEVICE_RESET = 0xF0,
	SET_READ_POINTER = 0xE1,
	WRITE_CONFIG = 0xD2,
	CHANNEL_SELECT = 0xC3, /* DS2482-800 */
	ADJUST_PORT = 0xC3,    /* DS2483, DS2484 */
	WIRE_RESET = 0xB4,
	WIRE_BIT = 0x87,
	WIRE_WRITE = 0xA5,
	WIRE_READ = 0x96,
	WIRE_TRIPLET = 0x78,

	AT_STATUS = 0xF0,
	AT_DATA = 0xE1,
	AT_CHANNEL = 0xD2,
	AT_CONFIG = 0xC3,
	AT_PORT = 0xB4,
};

/* DS2482-800, "Valid Channel Selection Codes": written, and read back. */
static const uint8_t channel_code[8] = {0xF0, 0xE1, 0xD2, 0xC3, 0xB4, 0xA5, 0x96, 0x87};
static const uint8_t channel_readback[8] = {0xB8, 0xB1, 0xAA, 0xA3, 0x9C, 0x95, 0x8E, 0x87};

/*
 * Typical times, DS2482-100/-800 "1-Wire timing" in the electrical characteristics. Standard:
 * tRSTL 600, tRSTH 584, tMSP 70, tSLOT 69.3, tMSR 14 us; overdrive: 72, 74, 7.5, 10.5, 1.5 us.
 */
static const struct sim_timing ds2482_timing[2] = {
	{600 * US, 584 * US, 70 * US, 69300, 14 * US},
	{72 * US, 74 * US, 7500, 10500, 1500},
};

static bool is_adjustable(const struct sim_chip *chip)
{
	return chip->part == SIM_DS2483 || chip->part == SIM_DS2484;
}

const char *sim_part_name(enum sim_part part)
{
	static const char *const names[] = {
		[SIM_DS2482_100] = "DS2482-100", [SIM_DS2482_101] = "DS2482-101",
		[SIM_DS2482_800] = "DS2482-800", [SIM_DS2483] = "DS2483",
		[SIM_DS2484] = "DS2484",
	};

	return names[part];
}

/*
 * DS2484, "1-Wire port configuration": tRSTL 440 + 20 v (44 + 2 v) us; tMSP 58, 58, 60, 63, 66,
 * 68, 70... us; tW0L 52 + 2 v (5 + 0.5 v) us; tREC0 2.75 for 0 to 5, then 5.25, 7.75... us. The
 * default is 6 for all.
 */
static struct sim_timing adjusted_timing(const struct sim_chip *chip, bool od)
{
	struct sim_timing timing = ds2482_timing[od];
	int64_t low = chip->port[0][od], zero = chip->port[2][od], recovery = chip->port[3][0];

	timing.reset_low_ns = od ? 44 * US + low * 2 * US : 440 * US + low * 20 * US;
	timing.reset_high_ns = timing.reset_low_ns;
	timing.slot_ns = od ? 5 * US + zero * 500 : 52 * US + zero * 2 * US;
	timing.slot_ns += 2750 + (recovery > 5 ? (recovery - 5) * 2500 : 0);
	return timing;
}

struct sim_timing sim_chip_timing(const struct sim_chip *chip)
{
	bool od = chip->config & SIM_1WS;
	struct sim_timing timing = is_adjustable(chip) ? adjusted_timing(chip, od)
	                                               : ds2482_timing[od];
	int64_t percent = chip->percent ? chip->percent : 100;

	timing.reset_low_ns = timing.reset_low_ns * percent / 100;
	timing.reset_high_ns = timing.reset_high_ns * percent / 100;
	timing.presence_ns = timing.presence_ns * percent / 100;
	timing.slot_ns = timing.slot_ns * percent / 100;
	timing.sample_ns = timing.sample_ns * percent / 100;
	return timing;
}

static struct sim_wire *selected_wire(struct sim_chip *chip)
{
	return &chip->wire[chip->channel];
}

static void end_strong(struct sim_chip *chip, int64_t t)
{
	if (!selected_wire(chip)->strong)
		return;
	sim_wire_strong(selected_wire(chip), false, t);
	chip->config &= (uint8_t)~SIM_SPU;
}

static void device_reset(struct sim_chip *chip, int64_t t)
{
	sim_wire_strong(selected_wire(chip), false, t);
	sim_wire_power(selected_wire(chip), true, t);
	chip->op = 0;
	if (chip->stuck == SIM_STUCK)
		chip->stuck = SIM_FREE;
	chip->status = SIM_RST;
	chip->config = chip->channel = 0;
	chip->pointer = AT_STATUS;
	memset(chip->port, 6, sizeof(chip->port));
}

void sim_chip_init(struct sim_chip *chip, enum sim_part part, uint8_t address)
{
	*chip = (struct sim_chip){.part = part, .address = address};
	chip->channels = part == SIM_DS2482_800 ? 8 : 1;
	device_reset(chip, 0);
}

void sim_chip_clear(struct sim_chip *chip)
{
	for (unsigned i = 0; i < 8; i++)
		sim_wire_clear(&chip->wire[i]);
}

void sim_chip_power_on(struct sim_chip *chip, int64_t t)
{
	sim_chip_run(chip, t);
	device_reset(chip, t);
	chip->data = 0;
	chip->writing = false;
}

static void set_bit(uint8_t *reg, uint8_t bit, bool on)
{
	*reg = (uint8_t)(on ? *reg | bit : *reg & ~bit);
}

static bool slot_value(const struct sim_chip *chip, unsigned slot)
{
	switch (chip->op) {
	case WIRE_BIT:
		return chip->op_data & 0x80;
	case WIRE_WRITE:
		return chip->op_data >> slot & 1;
	case WIRE_TRIPLET:
		return slot < 2 || (chip->status & SIM_DIR);
	default:
		return true;
	}
}

static void slot_result(struct sim_chip *chip, unsigned slot, bool line)
{
	bool id;

	switch (chip->op) {
	case WIRE_BIT:
		set_bit(&chip->status, SIM_SBR, line);
		break;
	case WIRE_WRITE: /* not in the data sheet; the hardware does it, owserver relies on it */
	case WIRE_READ:
		chip->data = (uint8_t)(chip->data >> 1 | (line ? 0x80 : 0));
		break;
	case WIRE_TRIPLET:
		if (slot == 0)
			set_bit(&chip->status, SIM_SBR, line);
		if (slot != 1)
			break;
		set_bit(&chip->status, SIM_TSB, line);
		id = chip->status & SIM_SBR;
		if (id == line)
			id = line || (chip->op_data & 0x80);
		set_bit(&chip->status, SIM_DIR, id);
		break;
	}
}

static void do_slot(struct sim_chip *chip, int64_t t)
{
	bool overdrive = chip->config & SIM_1WS;
	bool present;

	if (chip->op == WIRE_RESET) {
		present = sim_wire_reset(selected_wire(chip), overdrive, t);
		set_bit(&chip->status, SIM_PPD, present);
		set_bit(&chip->status, SIM_SD, !sim_wire_level(selected_wire(chip), t));
		return;
	}
	slot_result(
		chip, chip->op_done,
		sim_wire_slot(selected_wire(chip), slot_value(chip, chip->op_done), overdrive, t));
}

static void finish_operation(struct sim_chip *chip)
{
	bool feeds = chip->op == WIRE_BIT || chip->op == WIRE_WRITE;

	if (feeds && (chip->config & SIM_SPU))
		sim_wire_strong(selected_wire(chip), true, chip->op_end);
	chip->wire_ns += chip->op_end - chip->op_start;
	chip->op = 0;
	chip->status &= (uint8_t)~SIM_1WB;
}

void sim_chip_run(struct sim_chip *chip, int64_t t)
{
	struct sim_timing timing;

	if (!chip->op)
		return;
	timing = sim_chip_timing(chip);
	while (chip->op_done < chip->op_slots) {
		int64_t due = chip->op_start + chip->op_done * timing.slot_ns + timing.sample_ns;

		if (chip->op == WIRE_RESET)
			due = chip->op_start + timing.reset_low_ns + timing.presence_ns;
		if (due > t)
			return;
		do_slot(chip, due);
		chip->op_done++;
	}
	if (chip->op_end <= t)
		finish_operation(chip);
}

static void chip_begin(struct sim_chip *chip, uint8_t op, unsigned slots, uint8_t data, int64_t t)
{
	struct sim_timing timing = sim_chip_timing(chip);
	int64_t takes = slots * timing.slot_ns;

	end_strong(chip, t);
	if (op == WIRE_RESET)
		takes = timing.reset_low_ns + timing.reset_high_ns;
	chip->op = op;
	chip->op_data = data;
	chip->op_slots = slots;
	chip->op_done = 0;
	chip->op_start = t;
	chip->op_end = t + takes;
	chip->status |= SIM_1WB;
	chip->pointer = AT_STATUS;
	chip->operations++;
}

bool sim_chip_start(struct sim_chip *chip, bool read, int64_t t)
{
	sim_chip_run(chip, t);
	chip->writing = false;
	if (chip->asleep)
		return false;
	chip->writing = !read;
	chip->parameter = false;
	chip->port_at = 0;
	return true;
}

static bool is_busy(const struct sim_chip *chip)
{
	return chip->stuck != SIM_FREE || (chip->status & SIM_1WB);
}

/* Valid command codes are acknowledged, those for the wire only while it is idle. */
static bool take_chip_command(struct sim_chip *chip, uint8_t command, int64_t t)
{
	switch (command) {
	case DEVICE_RESET:
		device_reset(chip, t);
		return true;
	case SET_READ_POINTER:
		return true;
	}
	if (is_busy(chip))
		return false;
	switch (command) {
	case CHANNEL_SELECT:
		return chip->part == SIM_DS2482_800 || is_adjustable(chip);
	case WIRE_RESET:
		chip_begin(chip, WIRE_RESET, 1, 0, t);
		return true;
	case WIRE_READ:
		chip_begin(chip, WIRE_READ, 8, 0xFF, t);
		return true;
	}
	return command == WRITE_CONFIG || command == WIRE_BIT || command == WIRE_WRITE ||
	       command == WIRE_TRIPLET;
}

static bool set_pointer(struct sim_chip *chip, uint8_t code)
{
	if (code != AT_STATUS && code != AT_DATA && code != AT_CONFIG &&
	    !(code == AT_CHANNEL && chip->part == SIM_DS2482_800) &&
	    !(code == AT_PORT && is_adjustable(chip)))
		return false;
	chip->pointer = code;
	return true;
}

static bool write_config(struct sim_chip *chip, uint8_t byte, int64_t t)
{
	uint8_t config = byte & 0x0F;

	if ((byte >> 4 ^ config) != 0x0F)
		return false;
	if (!is_adjustable(chip))
		config &= (uint8_t)~SIM_PDN; /* PPM of old revisions: reads back 0 */
	if (!(config & SIM_SPU))
		end_strong(chip, t);
	chip->config = config;
	if (is_adjustable(chip))
		sim_wire_power(selected_wire(chip), !(config & SIM_PDN), t);
	chip->status &= (uint8_t)~SIM_RST;
	chip->pointer = AT_CONFIG;
	return true;
}

static bool select_channel(struct sim_chip *chip, uint8_t code, int64_t t)
{
	for (uint8_t i = 0; i < 8; i++) {
		if (channel_code[i] != code)
			continue;
		if (i != chip->channel)
			end_strong(chip, t);
		chip->channel = i;
		chip->pointer = AT_CHANNEL;
		return true;
	}
	return false;
}

static bool adjust_port(struct sim_chip *chip, uint8_t byte)
{
	unsigned parameter = byte >> 5, overdrive = byte >> 4 & 1;

	if (parameter >= SIM_PORT_PARAMETERS)
		return false;
	if (parameter >= 3) /* tREC0 and RWPU have one value for both speeds */
		overdrive = 0;
	chip->port[parameter][overdrive] = byte & 0x0F;
	chip->pointer = AT_PORT;
	return true;
}

static bool take_parameter(struct sim_chip *chip, uint8_t byte, int64_t t)
{
	switch (chip->command) {
	case SET_READ_POINTER:
		return set_pointer(chip, byte);
	case WRITE_CONFIG:
		return write_config(chip, byte, t);
	case CHANNEL_SELECT:
		return is_adjustable(chip) ? adjust_port(chip, byte)
		                           : select_channel(chip, byte, t);
	case WIRE_BIT:
		chip_begin(chip, WIRE_BIT, 1, byte, t);
		return true;
	case WIRE_WRITE:
		chip_begin(chip, WIRE_WRITE, 8, byte, t);
		return true;
	case WIRE_TRIPLET:
		chip_begin(chip, WIRE_TRIPLET, 3, byte, t);
		return true;
	}
	return false;
}

bool sim_chip_write(struct sim_chip *chip, uint8_t byte, int64_t t)
{
	bool taken;

	sim_chip_run(chip, t);
	if (!chip->writing)
		return false;
	if (!chip->parameter) {
		chip->command = byte;
		taken = take_chip_command(chip, byte, t);
		chip->parameter = true;
	} else {
		taken = take_parameter(chip, byte, t);
		/*
		 * DS2484, "Adjust 1-Wire Port": parameters may follow each other; nothing else may.
		 */
		if (chip->command != ADJUST_PORT || !is_adjustable(chip))
			chip->command = 0;
	}
	if (!taken)
		chip->writing = false; /* nothing more until the next START */
	return taken;
}

uint8_t sim_chip_read(struct sim_chip *chip, int64_t t)
{
	uint8_t at;

	sim_chip_run(chip, t);
	switch (chip->pointer) {
	case AT_DATA:
		return chip->data;
	case AT_CONFIG:
		return chip->config;
	case AT_CHANNEL:
		return channel_readback[chip->channel];
	case AT_PORT:
		/* tRSTL, tMSP, tW0L, each at both speeds, then tREC0 and RWPU; and again. */
		at = chip->port_at;
		chip->port_at = (uint8_t)((at + 1) % 8);
		return at < 6 ? chip->port[at / 2][at % 2] : chip->port[at - 3][0];
	default:
		set_bit(&chip->status, SIM_LL, sim_wire_level(selected_wire(chip), t));
		return (uint8_t)(chip->status | (chip->stuck != SIM_FREE ? SIM_1WB : 0));
	}
}
