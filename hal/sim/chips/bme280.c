/* SPDX-License-Identifier: MIT */
/*
 * BME280 (Bosch BST-BME280-DS001, "Combined humidity and pressure sensor"): forced measurements,
 * raw results, and the calibration that makes values of them. Normal mode and the filter are not
 * simulated.
 */
#include <string.h>

#include "hal/sim/chips/sensor.h"

enum {
	CALIBRATION = 0x88,
	HUMIDITY_1 = 0xA1,
	ID = 0xD0,
	RESET = 0xE0,
	HUMIDITY_2 = 0xE1,
	CTRL_HUM = 0xF2,
	STATUS = 0xF3,
	CTRL_MEAS = 0xF4,
	CONFIG = 0xF5,
	DATA = 0xF7,
};
enum { RESET_WORD = 0xB6, FORCED = 1, MEASURING = 0x08 };

/* Those of temperature and pressure are the example of the data sheet of the BMP280. */
static const int t_digits[3] = {27504, 26435, -1000};
static const int p_digits[9] = {36477, -10685, 3024, 2855, 140, -7, 15500, -14600, 6000};
enum { H1 = 75, H2 = 362, H3 = 0, H4 = 313, H5 = 50, H6 = 30 };

/* The compensation formulas, in floating point ("Appendix A"): raw to value. */
static double fine_of(double raw)
{
	double a = (raw / 16384 - t_digits[0] / 1024.0) * t_digits[1];
	double b = raw / 131072 - t_digits[0] / 8192.0;

	return a + b * b * t_digits[2];
}

static double temperature_of(double raw, double fine)
{
	(void)fine;
	return fine_of(raw) / 5120;
}

static double pressure_of(double raw, double fine)
{
	const int *p = p_digits;
	double a = fine / 2 - 64000, b = a * a * p[5] / 32768 + a * p[4] * 2;
	double pressure;

	b = b / 4 + p[3] * 65536.0;
	a = (p[2] * a * a / 524288 + p[1] * a) / 524288;
	a = (1 + a / 32768) * p[0];
	pressure = (1048576 - raw - b / 4096) * 6250 / a;
	a = p[8] * pressure * pressure / 2147483648.0;
	b = pressure * p[7] / 32768;
	return (pressure + (a + b + p[6]) / 16) / 100;
}

static double humidity_of(double raw, double fine)
{
	double h = fine - 76800;

	h = (raw - (H4 * 64.0 + H5 / 16384.0 * h)) *
	    (H2 / 65536.0 * (1 + H6 / 67108864.0 * h * (1 + H3 / 67108864.0 * h)));
	return h * (1 - H1 * h / 524288);
}

/* The raw result whose value is the nearest; the formulas rise or fall over their range. */
static uint32_t raw_of(double value, unsigned bits, double (*of)(double, double), double fine)
{
	double least = 0, most = (double)((1u << bits) - 1);
	bool rises = of(most, fine) > of(least, fine);

	while (most - least > 0.25) {
		double middle = (least + most) / 2;

		if ((of(middle, fine) < value) == rises)
			least = middle;
		else
			most = middle;
	}
	return (uint32_t)sim_round(least);
}

static void bme280_power_on(struct sim_sensor *sensor)
{
	uint8_t *reg = sensor->reg, *h = reg + HUMIDITY_2;

	memset(reg, 0, sizeof(sensor->reg));
	for (unsigned i = 0; i < 3; i++)
		sim_put(reg + CALIBRATION + 2 * i, 2, t_digits[i]);
	for (unsigned i = 0; i < 9; i++)
		sim_put(reg + CALIBRATION + 6 + 2 * i, 2, p_digits[i]);
	reg[HUMIDITY_1] = H1;
	sim_put(h, 2, H2);
	h[2] = H3;
	h[3] = H4 >> 4;
	h[4] = (H4 & 15) | (H5 & 15) << 4;
	h[5] = H5 >> 4;
	h[6] = H6;
	reg[ID] = 0x60;
	reg[DATA] = reg[DATA + 3] = reg[DATA + 6] = 0x80; /* nothing was measured */
	sensor->until = 0;
}

/* Oversampling 1, 2, 4, 8, 16; 0: not measured. */
static unsigned samples(unsigned setting)
{
	return setting == 0 ? 0 : setting > 5 ? 16 : 1u << (setting - 1);
}

/* The registers get the results now, and show the measurement until its end. */
static void bme280_measure(struct sim_slave *slave, struct sim_sensor *sensor)
{
	unsigned of_t = samples(sensor->reg[CTRL_MEAS] >> 5);
	unsigned of_p = samples(sensor->reg[CTRL_MEAS] >> 2 & 7);
	unsigned of_h = samples(sensor->reg[CTRL_HUM] & 7);
	uint32_t raw = raw_of(sim_input_now(slave, SENSOR_TEMPERATURE), 20, temperature_of, 0);
	double fine = fine_of(raw);
	uint8_t *data = sensor->reg + DATA;
	int64_t us = 1250 + 2300 * (int64_t)of_t;

	us += of_p ? 2300 * (int64_t)of_p + 575 : 0;
	us += of_h ? 2300 * (int64_t)of_h + 575 : 0;
	sensor->until = slave->now + us * 1000;
	sim_put_high(data + 3, 3, (of_t ? raw : 0x80000) << 4);
	raw = raw_of(sim_input_now(slave, SENSOR_PRESSURE), 20, pressure_of, fine);
	sim_put_high(data, 3, (of_p ? raw : 0x80000) << 4);
	raw = raw_of(sim_input_now(slave, SENSOR_HUMIDITY), 16, humidity_of, fine);
	sim_put_high(data + 6, 2, of_h ? raw : 0x8000);
	slave->conversions++;
}

/* Register, byte, register, byte. */
static bool bme280_take(struct sim_slave *slave, struct sim_sensor *sensor, uint8_t byte,
                        unsigned at)
{
	if (at % 2 == 0)
		sensor->pointer = byte;
	else if (sensor->pointer == RESET && byte == RESET_WORD)
		bme280_power_on(sensor);
	else if (sensor->pointer == CTRL_HUM || sensor->pointer == CTRL_MEAS ||
	         sensor->pointer == CONFIG)
		sensor->reg[sensor->pointer] = byte;
	if (at % 2 == 1 && sensor->pointer == CTRL_MEAS && (byte & 3) && (byte & 3) <= 2 * FORCED) {
		bme280_measure(slave, sensor);
		sensor->reg[CTRL_MEAS] &= 0xFC; /* it sleeps again */
	}
	return true;
}

static uint8_t bme280_give(struct sim_slave *slave, struct sim_sensor *sensor, unsigned at)
{
	uint8_t reg = sensor->pointer++;

	(void)at;
	if (reg == STATUS)
		return slave->now < sensor->until ? MEASURING : 0;
	return sensor->reg[reg];
}

const struct sim_sensor_kind sim_sensor_bme280 = {
	.power_on = bme280_power_on, .write = bme280_take, .read = bme280_give};
