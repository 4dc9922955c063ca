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

static void vcnl4040_power_on(struct sim_sensor *sensor)
{
	memset(sensor->reg, 0, sizeof(sensor->reg));
	sensor->reg[2 * ALS_CONF] = sensor->reg[2 * PS_CONF] = SHUT_DOWN;
	sensor->reg[2 * ID] = 0x86;
	sensor->reg[2 * ID + 1] = 0x01;
}

static uint16_t within(double value)
{
	return (uint16_t)(value < 0 ? 0 : value > 65535 ? 65535 : sim_round(value));
}

static void vcnl4040_put(struct sim_sensor *sensor, unsigned command, uint16_t word)
{
	sensor->reg[2 * command] = (uint8_t)word;
	sensor->reg[2 * command + 1] = (uint8_t)(word >> 8);
}

/* What is switched on measures. 0.1 lux a step at 80 ms, and half of it at twice the time. */
static void vcnl4040_measure(struct sim_slave *slave, struct sim_sensor *sensor, int64_t t)
{
	uint8_t light = sensor->reg[2 * ALS_CONF];
	double steps = sim_input_at(slave, SENSOR_LIGHT, t) * 10 * (1 << (light >> 6));

	if (!(light & SHUT_DOWN)) {
		vcnl4040_put(sensor, ALS_DATA, within(steps));
		vcnl4040_put(sensor, WHITE_DATA, within(steps));
	}
	if (!(sensor->reg[2 * PS_CONF] & SHUT_DOWN))
		vcnl4040_put(sensor, PS_DATA, within(sim_input_at(slave, SENSOR_PROXIMITY, t)));
}

static bool vcnl4040_take(struct sim_slave *slave, struct sim_sensor *sensor, uint8_t byte,
                          unsigned at, int64_t t)
{
	if (at == 0) {
		vcnl4040_measure(slave, sensor, t);
		sensor->pointer = byte;
		return byte <= LAST;
	}
	if (at > 2)
		return false;
	if (sensor->pointer < CONFIGURATIONS)
		sensor->reg[2 * sensor->pointer + at - 1] = byte;
	return true;
}

static uint8_t vcnl4040_give(struct sim_slave *slave, struct sim_sensor *sensor, unsigned at,
                             int64_t t)
{
	(void)slave;
	(void)t;
	return at < 2 && sensor->pointer <= LAST ? sensor->reg[2 * sensor->pointer + at] : 0xFF;
}

const struct sim_sensor_kind sim_sensor_vcnl4040 = {.name = "vcnl4040",
                                                    .power_on = vcnl4040_power_on,
                                                    .write = vcnl4040_take,
                                                    .read = vcnl4040_give};
