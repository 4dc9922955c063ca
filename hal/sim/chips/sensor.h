/* SPDX-License-Identifier: MIT */
/*
 * An I2C part behind a bridge (sensors.h), as each part's file knows it. The time is slave->now.
 */
#pragma once

#include "hal/sim/slave.h"

/* Inputs of a bridge: what its sensors measure, and what drives the pins of a MCP23017. */
enum sim_sensor_input {
	SENSOR_TEMPERATURE,
	SENSOR_HUMIDITY,
	SENSOR_PRESSURE,
	SENSOR_LIGHT,
	SENSOR_PROXIMITY,
	SENSOR_PINS,
};

enum { SENSOR_PARTS = 4, SENSOR_REGISTERS = 256 };

struct sim_sensor {
	uint8_t address; /* 7 bits; 0: it is not there */
	uint8_t reg[SENSOR_REGISTERS];
	uint8_t pointer;
	uint8_t out[6]; /* the result of a command */
	uint8_t out_at, out_count;
	int64_t until; /* the measurement under way ends */
};

/* A part. Its measured quantities are the inputs of the slave. */
struct sim_sensor_kind {
	void (*power_on)(struct sim_sensor *sensor);
	/* Does it take its address now? */
	bool (*selects)(const struct sim_sensor *sensor, bool reading, int64_t t);
	/* at: how many bytes have come before since it took its address. False: not taken. */
	bool (*write)(struct sim_slave *slave, struct sim_sensor *sensor, uint8_t byte,
	              unsigned at);
	uint8_t (*read)(struct sim_slave *slave, struct sim_sensor *sensor, unsigned at);
};

extern const struct sim_sensor_kind sim_sensor_sht4x, sim_sensor_bme280, sim_sensor_vcnl4040,
	sim_sensor_mcp23017;
