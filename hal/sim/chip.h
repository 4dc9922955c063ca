/* SPDX-License-Identifier: MIT */
/*
 * A simulated I2C to 1-Wire bridge at the level of its I2C bytes: DS2482-100, -101, -800, DS2483,
 * DS2484, by their data sheets (DS2482-100 rev. 19-4930, DS2482-800 rev. 19-4932, DS2484
 * 19-6494). 1-Wire operations run by the clock: what is due at t has happened, what is not has
 * not, and a device reset in between ends the rest.
 *
 * t is ns since the start of the simulation and never goes back.
 */
#pragma once

#include "hal/sim/wire.h"

enum sim_part { SIM_DS2482_100, SIM_DS2482_101, SIM_DS2482_800, SIM_DS2483, SIM_DS2484 };

/* Status register. */
enum {
	SIM_1WB = 0x01,
	SIM_PPD = 0x02,
	SIM_SD = 0x04,
	SIM_LL = 0x08,
	SIM_RST = 0x10,
	SIM_SBR = 0x20,
	SIM_TSB = 0x40,
	SIM_DIR = 0x80,
};
/* Configuration register. */
enum { SIM_APU = 0x01, SIM_PDN = 0x02, SIM_SPU = 0x04, SIM_1WS = 0x08 };

enum sim_stuck {
	SIM_FREE,
	SIM_STUCK,      /* until a device reset */
	SIM_STUCK_FAST, /* the chip stays stuck whatever the host does */
};

#define SIM_PORT_PARAMETERS 5 /* tRSTL, tMSP, tW0L, tREC0, RWPU */

struct sim_timing {
	int64_t reset_low_ns, reset_high_ns, presence_ns, slot_ns, sample_ns;
};

struct sim_chip {
	enum sim_part part;
	uint8_t address; /* 7 bits */
	struct sim_wire wire[8];
	unsigned channels;
	enum sim_stuck stuck; /* 1WB stays set */
	bool asleep;          /* SLPZ low (-101, DS2483, DS2484): deaf */
	int percent;          /* of the typical 1-Wire times, 95..105 by the data sheet; 0: 100 */

	uint8_t status, config, channel, data, pointer;
	uint8_t port[SIM_PORT_PARAMETERS][2];
	uint8_t port_at;         /* next byte of the port configuration to read */
	uint8_t command;         /* the command of this write; 0 after its parameter */
	bool writing, parameter; /* in a write; its parameter comes next */
	/* The 1-Wire operation under way. */
	uint8_t op, op_data; /* command code, 0: none */
	unsigned op_slots, op_done;
	int64_t op_start, op_end;
	uint64_t operations; /* 1-Wire commands taken */
	int64_t wire_ns;     /* time of all operations ended */
};

void sim_chip_init(struct sim_chip *chip, enum sim_part part, uint8_t address);
void sim_chip_clear(struct sim_chip *chip); /* clears its slaves too */
const char *sim_part_name(enum sim_part part);
void sim_chip_power_on(struct sim_chip *chip, int64_t t);
/* What the chip's 1-Wire times are now. */
struct sim_timing sim_chip_timing(const struct sim_chip *chip);

/* Carry out what is due up to t. */
void sim_chip_run(struct sim_chip *chip, int64_t t);
/* START and address byte; t: its acknowledge bit. False: refused. */
bool sim_chip_start(struct sim_chip *chip, bool read, int64_t t);
/* Take a byte; t: its acknowledge bit. False: refused. */
bool sim_chip_write(struct sim_chip *chip, uint8_t byte, int64_t t);
/* Send a byte that begins at t. */
uint8_t sim_chip_read(struct sim_chip *chip, int64_t t);
