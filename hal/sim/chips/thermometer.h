/* SPDX-License-Identifier: MIT */
/*
 * What the thermometers' family files share: DS18B20 and its relatives, and what families 3B are.
 */
#pragma once

#include "hal/sim/pins.h"

enum { SIM_TEMPERATURE, SIM_PIN_A, SIM_PIN_B }; /* inputs */

/* What a kind of clone of the DS18B20 does unlike it. */
struct sim_clone {
	uint8_t first[8];                       /* the scratchpad after power-on */
	uint16_t ms[4];                         /* a conversion of 9 to 12 bits */
	enum { AS_GENUINE, KEPT, JOKER } sixth; /* byte 6 after a conversion */
	bool fixed;                             /* to 12 bits */
	bool polls_late, never_polls;           /* its busy slots */
	bool overwrites;  /* the byte after TL gets into byte 6, two more in 6, 7 */
	bool no_parasite; /* it does not work without a supply line */
	bool keeps;       /* a short loss of power changes nothing */
	uint8_t copies;   /* its EEPROM endures; 255: enough */
};

struct sim_thermometer {
	struct sim_pins pins;          /* first; DS28EA00 */
	const struct sim_clone *clone; /* NULL: genuine */
	uint8_t copies;                /* of the EEPROM, in a clone */
	uint8_t scratchpad[8];         /* temperature, TH, TL, configuration, three more */
	uint8_t eeprom[3];             /* TH, TL, configuration */
	uint8_t address;               /* DS1825: AD0..AD3 */
	bool fixed;                    /* a clone: stays at 12 bits, whatever is written */
	uint8_t counts;                /* of a degree, in a DS1820 of the 1990s; 0 means 16 */
	uint8_t percent;               /* of the conversion time by the data sheet; 0 means 100 */
	bool alarm, copying;
	bool once;      /* a Convert T while it converts is ignored; else it begins anew */
	bool upset;     /* while it converts, the temperature in the scratchpad is not the last */
	bool no_recall; /* a clone: does not know Recall E2 */
};

/* MAX31826, with its memory, and MAX31850. */
enum { SIM_MAX_MEMORY = 128, SIM_MAX_PAGE = 8 };
struct sim_max {
	uint8_t scratchpad[8];
	uint8_t memory[SIM_MAX_MEMORY], second[SIM_MAX_PAGE], target;
	uint8_t address; /* AD0..AD3 */
	bool copying;
	bool locked;     /* the memory is worn out: it takes nothing */
	bool garbled;    /* the second scratchpad is read wrong */
	unsigned copies; /* for the tests */
};
