/* SPDX-License-Identifier: MIT */
/*
 * SHT4x (Sensirion, "4th generation, high-accuracy, ultra-low-power" humidity and temperature
 * sensor): commands of one byte, results with CRC8; the heater is not simulated.
 */

#include "hal/sim/chips/sensor.h"

enum { SERIAL = 0x89, RESET = 0x94 };

/* x^8 + x^5 + x^4 + 1, most significant bit first, started with FFh. */
static uint8_t crc(const uint8_t *bytes)
{
	uint8_t sum = 0xFF;

	for (unsigned i = 0; i < 16; i++) {
		if (i % 8 == 0)
			sum ^= bytes[i / 8];
		sum = (uint8_t)(sum & 0x80 ? sum << 1 ^ 0x31 : sum << 1);
	}
	return sum;
}

static void sht4x_put(uint8_t *out, int word)
{
	sim_put_high(out, 2, word);
	out[2] = crc(out);
}

/* Times are the longest; 0: no such measurement. */
static int64_t measures(uint8_t command)
{
	switch (command) {
	case 0xFD: /* high, medium, low precision */
		return 8300 * INT64_C(1000);
	case 0xF6:
		return 4500 * INT64_C(1000);
	case 0xE0:
		return 1600 * INT64_C(1000);
	default:
		return 0;
	}
}

static void sht4x_power_on(struct sim_sensor *sensor)
{
	sensor->out_count = 0;
	sensor->until = 0;
}

/* It does not take its address while it measures, nor to be read without a result. */
static bool selects(const struct sim_sensor *sensor, bool reading, int64_t t)
{
	return t >= sensor->until && (!reading || sensor->out_count);
}

static bool sht4x_take(struct sim_slave *slave, struct sim_sensor *sensor, uint8_t byte,
                       unsigned at)
{
	double temperature = sim_input_now(slave, SENSOR_TEMPERATURE);
	double humidity = sim_input_now(slave, SENSOR_HUMIDITY);

	sensor->out_count = 0;
	sensor->until = slave->now + measures(byte);
	if (at > 0)
		return false;
	if (byte == SERIAL) {
		sht4x_put(sensor->out, slave->rom[1] << 8 | slave->rom[2]);
		sht4x_put(sensor->out + 3, slave->rom[3] << 8 | slave->rom[4]);
	} else if (measures(byte)) {
		sht4x_put(sensor->out, sim_within((temperature + 45) / 175 * 65535, 0, 65535));
		sht4x_put(sensor->out + 3, sim_within((humidity + 6) / 125 * 65535, 0, 65535));
		slave->conversions++;
	} else {
		return byte == RESET;
	}
	sensor->out_count = 6;
	return true;
}

/* A result is read once. */
static uint8_t sht4x_give(struct sim_slave *slave, struct sim_sensor *sensor, unsigned at)
{
	(void)slave;
	sensor->out_count = 0;
	return at < sizeof(sensor->out) ? sensor->out[at] : 0xFF;
}

const struct sim_sensor_kind sim_sensor_sht4x = {
	.power_on = sht4x_power_on,
	.selects = selects,
	.write = sht4x_take,
	.read = sht4x_give,
};
