/* SPDX-License-Identifier: MIT */
/* DS28EA00: a DS18B20 with two switches. */
#include "hal/native/pio.h"
#include "hal/native/thermometer.h"

#define WRITE_PIO 0xa5

static const struct property properties[] = {
	PIO_BITS("PIO", ACCESS_BOTH, WRITE_PIO, pio_read_output, pio_write_output),
	THERMOMETER_TEMPERATURE("fasttemp", 9),
	PIO_BITS("latch", ACCESS_BOTH, WRITE_PIO, pio_read_latch, pio_write_latch),
	THERMOMETER_LATEST,
	{.name = "piostate", .type = PROPERTY_UNSIGNED, .life = LIFE_VOLATILE, .hidden = true,
	 .access = ACCESS_READ, .read = pio_read_state},
	THERMOMETER_POWER,
	PIO_BITS("sensed", ACCESS_READ, 0, pio_read_pin, NULL),
	THERMOMETER_TEMPERATURE("temperature", CONVERT_TEMPRES),
	THERMOMETER_TEMPERATURE("temperature10", 10),
	THERMOMETER_TEMPERATURE("temperature11", 11),
	THERMOMETER_TEMPERATURE("temperature12", 12),
	THERMOMETER_TEMPERATURE("temperature9", 9),
	THERMOMETER_LIMIT("temphigh", SP_HIGH),
	THERMOMETER_LIMIT("templow", SP_LOW),
	THERMOMETER_TEMPRES,
};

const struct family family_42 = {
	.code = 0x42, .thermometer = true, .alarms = true, .type = "DS28EA00",
	PROPERTIES(properties),
};
