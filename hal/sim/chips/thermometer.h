/* SPDX-License-Identifier: MIT */
/*
 * What the thermometers' family files share: DS18B20 and its relatives, and what families 3B are.
 */
#ifndef HAL_SIM_CHIPS_THERMOMETER_H
#define HAL_SIM_CHIPS_THERMOMETER_H

#include "hal/sim/pins.h"

enum { SIM_TEMPERATURE, SIM_PIN_A, SIM_PIN_B }; /* inputs */

struct sim_thermometer {
	struct sim_pins pins;  /* first; DS28EA00 */
	uint8_t scratchpad[8]; /* temperature, TH, TL, configuration, three more */
	uint8_t eeprom[3];     /* TH, TL, configuration */
	uint8_t address;       /* DS1825: AD0..AD3 */
	bool fixed;            /* a clone: stays at 12 bits, whatever is written */
	int percent;           /* of the conversion time by the data sheet; 0 means 100 */
	bool alarm, copying;
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

#endif
