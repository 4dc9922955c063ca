/* SPDX-License-Identifier: MIT */
/* What the thermometers' family files share: DS18B20 and its relatives. */
#ifndef HAL_SIM_CHIPS_THERMOMETER_H
#define HAL_SIM_CHIPS_THERMOMETER_H

#include "hal/sim/slave.h"

enum { SIM_TEMPERATURE, SIM_PIN_A, SIM_PIN_B }; /* inputs */

struct sim_thermometer {
	uint8_t scratchpad[8]; /* temperature, TH, TL, configuration, three more */
	uint8_t eeprom[3];     /* TH, TL, configuration */
	uint8_t address;       /* DS1825: AD0..AD3 */
	uint8_t command, got;  /* function under way, bytes of it taken */
	uint8_t taken[3];
	bool fixed;  /* a clone: stays at 12 bits, whatever is written */
	int percent; /* of the conversion time by the data sheet; 0 means 100 */
	bool alarm;
	bool converting, copying;
	int64_t busy_since, busy_until;
	/* DS28EA00's pins: output latches, 1 is off. */
	uint8_t latch;
};

#endif
