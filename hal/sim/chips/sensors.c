/* SPDX-License-Identifier: MIT */
/* The I2C bus behind a bridge: which part takes an address, and who is spoken to. */
#include <errno.h>
#include <string.h>

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

int sim_sensors_option(struct sim_slave *slave, const char *name, double value)
{
	for (unsigned i = 0; i < SENSOR_PARTS; i++) {
		if (strcmp(kinds[i]->name, name) != 0)
			continue;
		if (value < 0x08 || value > 0x77 || value != (int)value)
			return -ERANGE;
		sim_state(slave, sim_sensors)->part[i].address = (uint8_t)value;
		return 0;
	}
	return -ENOENT;
}

void sim_sensors_power_on(struct sim_slave *slave)
{
	struct sim_sensors *s = slave->state;

	s->selected = -1;
	for (unsigned i = 0; i < SENSOR_PARTS; i++) {
		s->part[i] = (struct sim_sensor){.address = s->part[i].address};
		kinds[i]->power_on(&s->part[i]);
	}
}

bool sim_sensors_start(struct sim_slave *slave, uint8_t address, int64_t t)
{
	struct sim_sensors *s = slave->state;

	s->selected = -1;
	s->took = 0;
	for (int i = 0; i < SENSOR_PARTS; i++) {
		const struct sim_sensor *part = &s->part[i];

		if (part->address && part->address == address >> 1 &&
		    (!kinds[i]->selects || kinds[i]->selects(part, address & 1, t)))
			s->selected = i;
	}
	return s->selected >= 0;
}

bool sim_sensors_write(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct sim_sensors *s = slave->state;

	return s->selected >= 0 &&
	       kinds[s->selected]->write(slave, &s->part[s->selected], byte, s->took++, t);
}

uint8_t sim_sensors_read(struct sim_slave *slave, int64_t t)
{
	struct sim_sensors *s = slave->state;

	if (s->selected < 0)
		return 0xFF;
	return kinds[s->selected]->read(slave, &s->part[s->selected], s->took++, t);
}

void sim_sensors_stop(struct sim_slave *slave)
{
	sim_state(slave, sim_sensors)->selected = -1;
}
