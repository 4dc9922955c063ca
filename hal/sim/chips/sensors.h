/* SPDX-License-Identifier: MIT */
/*
 * The I2C bus behind a DS28E17 or a DS28E18, with the parts on it: SHT4x, BME280, VCNL4040,
 * MCP23017, each once at the most, at the address that its option gives. The state of the bridge
 * begins with a struct sim_sensors. The time is slave->now.
 */
#pragma once

#include "hal/sim/chips/sensor.h"

struct sim_sensors {
	struct sim_sensor part[SENSOR_PARTS];
	int selected;  /* the part that took its address; -1: none */
	unsigned took; /* bytes since then */
};

extern const struct sim_input sim_sensor_inputs[];
extern const struct sim_option sim_sensor_options[];

void sim_sensors_power_on(struct sim_slave *slave);
/* START and the address byte, acknowledged or not; what is written and read then; STOP. */
bool sim_sensors_start(struct sim_slave *slave, uint8_t address);
bool sim_sensors_write(struct sim_slave *slave, uint8_t byte);
uint8_t sim_sensors_read(struct sim_slave *slave);
void sim_sensors_stop(struct sim_slave *slave);
