/* SPDX-License-Identifier: MIT */
/*
 * The memories that are written through a scratchpad: target address, ending offset, a copy that
 * needs both as its key. The chips differ in sizes, codes, checksums and times.
 *
 * Room hal/sim/chips: simulated chips, from their data sheets.
 */
#pragma once

#include "hal/sim/pins.h"

struct sim_scratchpad_kind {
	uint16_t size;     /* of what can be read */
	uint16_t writable; /* of it, what can be written */
	uint8_t page;      /* bytes of the scratchpad: 8, 32 or 64 */
	int64_t copy_ns;
	bool whole;    /* a copy takes the whole scratchpad */
	bool to_end;   /* the scratchpad is read to its end, whatever was written */
	bool sequence; /* a read of the memory before the copy forbids it */
	bool plain;    /* no checksums, an overflow flag, and zeros after the copy */
};

#define SIM_SCRATCHPAD_MEMORY 0x8000
struct sim_scratchpad {
	struct sim_pins pins; /* first; of a memory with pins */
	uint8_t memory[SIM_SCRATCHPAD_MEMORY];
	uint8_t pad[64];
	uint16_t target;
	uint8_t status; /* E/S */
	bool bad_sequence;
};

/*
 * For struct sim_family. Its state begins with a struct sim_scratchpad, and its kind is a struct
 * sim_scratchpad_kind, or begins with one.
 */
#define SIM_SCRATCHPAD_FUNCTIONS(copy) SIM_SCRATCHPAD_COMMANDS(copy, sim_scratchpad_dump)
/* The same with a read of the memory that is the chip's own. */
#define SIM_SCRATCHPAD_COMMANDS(copy, dump) \
	{.code = 0x0F, .takes = 2, .start = sim_scratchpad_target, .byte = sim_scratchpad_write}, \
		{.code = 0xAA, .start = sim_scratchpad_read}, \
		{.code = (copy), .takes = 3, .start = sim_scratchpad_copy}, \
	{ \
		.code = 0xF0, .takes = 2, .start = (dump), .next = (dump) \
	}
#define SIM_DUMP_PAGES 0xA5
#define SIM_SCRATCHPAD_PAGES \
	.code = SIM_DUMP_PAGES, .takes = 2, .start = sim_scratchpad_dump, \
	.next = sim_scratchpad_dump
void sim_scratchpad_power_on(struct sim_slave *slave);
bool sim_scratchpad_bit(struct sim_slave *slave);
void sim_scratchpad_worked(struct sim_slave *slave);
/* For struct sim_function. */
void sim_scratchpad_target(struct sim_slave *slave);
void sim_scratchpad_write(struct sim_slave *slave, uint8_t byte);
void sim_scratchpad_read(struct sim_slave *slave);
void sim_scratchpad_copy(struct sim_slave *slave);
/* By SIM_DUMP_PAGES page by page, each with its checksum. */
void sim_scratchpad_dump(struct sim_slave *slave);

/*
 * Send the rest of the page at the address, a count, four bytes more, and the checksum; after the
 * last page be deaf.
 */
void sim_scratchpad_send_counted(struct sim_slave *slave, uint32_t count, const uint8_t more[4]);
