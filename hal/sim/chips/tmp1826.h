/* SPDX-License-Identifier: MIT */
/* The state of a simulated TMP1826 or TMP1827. */
#pragma once

#include "hal/sim/slave.h"

enum {
	SIM_TMP1826_MEMORY = 256,
	SIM_TMP1826_PAGE = 32, /* what a lock protects */
	SIM_TMP1826_BLOCK = 8,
	SIM_TMP1826_SETTINGS = 9,
	SIM_TMP1826_NOWHERE = 0xFFFF,
};

struct sim_tmp1826 {
	int16_t temperature; /* as in the register */
	uint8_t status;      /* flags that a reading clears */
	/* Configuration 1 and 2, short address, alert low and high, offset: now, in the EEPROM. */
	uint8_t settings[SIM_TMP1826_SETTINGS], stored[SIM_TMP1826_SETTINGS];
	uint8_t sent[18]; /* the first scratchpad as it is under way */
	uint8_t memory[SIM_TMP1826_MEMORY], second[SIM_TMP1826_BLOCK];
	uint16_t target; /* of the second scratchpad */
	uint8_t locked_pages;
	uint8_t work;
	bool checked_blocks; /* a CRC8 follows each block of the memory that is read */
};
