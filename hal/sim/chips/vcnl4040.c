/* SPDX-License-Identifier: MIT */
/*
 * VCNL4040 (Vishay 84274, "Fully integrated proximity and ambient light sensor"): registers of
 * words, low byte first. Thresholds, interrupts and integration times are kept, but only the
 * resolution of the light follows them; a result is there at once.
 */
#include <string.h>

#include "hal/sim/chips/sensor.h"

enum {
	ALS_CONF = 0x00,
	PS_CONF = 0x03,
	CONFIGURATIONS = 0x08, /* below this register all can be written */
	PS_DATA = 0x08,
	ALS_DATA = 0x09,
	WHITE_DATA = 0x0A,
	ID = 0x0C,
	LAST = ID,
};
enum { SHUT_DOWN = 1 };

static void vcnl4040_put(struct sim_sensor *sensor, unsigned command, double value)
{
	sim_put(sensor->reg + 2 * command, 2, sim_within(value, 0, 65535));
}

static void vcnl4040_power_on(struct sim_sensor *sensor)
{
	memset(sensor->reg, 0, sizeof(sensor->reg));
	sensor->reg[2 * ALS_CONF] = sensor->reg[2 * PS_CONF] = SHUT_DOWN;
	vcnl4040_put(sensor, ID, 0x186);
}

/* What is switched on measures. 0.1 lux a step at 80 ms, and half of it at twice the time. */
static void vcnl4040_measure(struct sim_slave *slave, struct sim_sensor *sensor)
{
	uint8_t light = sensor->reg[2 * ALS_CONF];
	double steps = sim_input_now(slave, SENSOR_LIGHT) * 10 * (1 << (light >> 6));

	if (!(light & SHUT_DOWN)) {
		vcnl4040_put(sensor, ALS_DATA, steps);
		vcnl4040_put(sensor, WHITE_DATA, steps);
	}
	if (!(sensor->reg[2 * PS_CONF] & SHUT_DOWN))
		vcnl4040_put(sensor, PS_DATA, sim_input_now(slave, SENSOR_PROXIMITY));
}

static bool vcnl4040_take(struct sim_slave *slave, struct sim_sensor *sensor, uint8_t byte,
                          unsigned at)
{
	if (at == 0) {
		vcnl4040_measure(slave, sensor);
		sensor->pointer = byte;
		return byte <= LAST;
	}
	if (at > 2)
		return false;
	if (sensor->pointer < CONFIGURATIONS)
		sensor->reg[2 * sensor->pointer + at - 1] = byte;
	return true;
}

static uint8_t vcnl4040_give(struct sim_slave *slave, struct sim_sensor *sensor, unsigned at)
{
	(void)slave;
	return at < 2 && sensor->pointer <= LAST ? sensor->reg[2 * sensor->pointer + at] : 0xFF;
}

const struct sim_sensor_kind sim_sensor_vcnl4040 = {
	.power_on = vcnl4040_power_on, .write = vcnl4040_take, .read = vcnl4040_give};
