/* SPDX-License-Identifier: MIT */
/* The I2C bus behind a bridge: the part that takes an address gets the bytes after it. */

#include "hal/sim/chips/sensors.h"

static const struct sim_sensor_kind *const kinds[SENSOR_PARTS] = {
	&sim_sensor_sht4x, &sim_sensor_bme280, &sim_sensor_vcnl4040, &sim_sensor_mcp23017};

const struct sim_input sim_sensor_inputs[] = {
	[SENSOR_TEMPERATURE] = {.name = "temperature", .start = 20, .least = -40, .most = 125},
	[SENSOR_HUMIDITY] = {.name = "humidity", .start = 50, .least = 0, .most = 100},
	[SENSOR_PRESSURE] = {.name = "pressure", .start = 1013.25, .least = 300, .most = 1100},
	[SENSOR_LIGHT] = {.name = "light", .start = 100, .least = 0, .most = 6553.5},
	[SENSOR_PROXIMITY] = {.name = "proximity", .least = 0, .most = 65535},
	[SENSOR_PINS] = {.name = "pins", .start = 65535, .least = 0, .most = 65535},
	{0},
};

#define ADDRESS(name, i) SIM_OPTION(sim_sensors, name, 0x08, 0x77, part[i].address)
const struct sim_option sim_sensor_options[] = {ADDRESS("sht4x", 0),
                                                ADDRESS("bme280", 1),
                                                ADDRESS("vcnl4040", 2),
                                                ADDRESS("mcp23017", 3),
                                                {0}};

void sim_sensors_power_on(struct sim_slave *slave)
{
	struct sim_sensors *s = slave->state;

	s->selected = -1;
	for (unsigned i = 0; i < SENSOR_PARTS; i++) {
		s->part[i] = (struct sim_sensor){.address = s->part[i].address};
		kinds[i]->power_on(&s->part[i]);
	}
}

bool sim_sensors_start(struct sim_slave *slave, uint8_t address)
{
	struct sim_sensors *s = slave->state;

	s->selected = -1;
	s->took = 0;
	for (int i = 0; i < SENSOR_PARTS; i++) {
		const struct sim_sensor *part = &s->part[i];

		if (part->address && part->address == address >> 1 &&
		    (!kinds[i]->selects || kinds[i]->selects(part, address & 1, slave->now)))
			s->selected = i;
	}
	return s->selected >= 0;
}

bool sim_sensors_write(struct sim_slave *slave, uint8_t byte)
{
	struct sim_sensors *s = slave->state;

	return s->selected >= 0 &&
	       kinds[s->selected]->write(slave, &s->part[s->selected], byte, s->took++);
}

uint8_t sim_sensors_read(struct sim_slave *slave)
{
	struct sim_sensors *s = slave->state;

	if (s->selected < 0)
		return 0xFF;
	return kinds[s->selected]->read(slave, &s->part[s->selected], s->took++);
}

void sim_sensors_stop(struct sim_slave *slave)
{
	sim_state(slave, sim_sensors)->selected = -1;
}
