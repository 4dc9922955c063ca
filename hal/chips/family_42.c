/* SPDX-License-Identifier: MIT */
/* DS28EA00: a DS18B20 with two switches. PIO is what the pins are, latch what they are set to. */
#include "hal/chips/pio.h"
#include "hal/chips/thermometer.h"

#define WRITE_PIO 0xa5

/* clang-format off */
static const struct property properties[] = {
	THERMOMETER_PROPERTIES,
	{.name = "PIO", .type = PROPERTY_BITS, .life = LIFE_VOLATILE, .access = ACCESS_BOTH,
	 .array = {2, INDEX_LETTERS, true}, .arg = WRITE_PIO, .read = pio_read_low,
	 .write = pio_write_output, .merge = pio_read_output},
	PIO_BITS("latch", ACCESS_BOTH, WRITE_PIO, pio_read_output, pio_write_output),
	{.name = "piostate", .type = PROPERTY_UNSIGNED, .life = LIFE_VOLATILE, .hidden = true,
	 .access = ACCESS_READ, .read = pio_read_state},
	PIO_BITS("sensed", ACCESS_READ, 0, pio_read_pin, NULL),
};
/* clang-format on */

const struct family family_42 = {
	.code = 0x42,
	.thermometer = true,
	.alarms = true,
	.type = "DS28EA00",
	PROPERTIES(properties),
};
