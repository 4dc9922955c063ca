/* SPDX-License-Identifier: MIT */
/* DS2413: two switches. */
#include "hal/chips/pio.h"

#define WRITE_PIO 0x5a

/* clang-format off */
static const struct property properties[] = {
	PIO_BITS("PIO", ACCESS_BOTH, WRITE_PIO, pio_read_output, pio_write_output),
	{.name = "piostate", .type = PROPERTY_UNSIGNED, .life = LIFE_VOLATILE, .hidden = true,
	 .access = ACCESS_BOTH, .digits = "3", .arg = WRITE_PIO, .read = pio_read_state,
	 .write = pio_write_state},
	PIO_BITS("sensed", ACCESS_READ, 0, pio_read_pin, NULL),
};
/* clang-format on */

const struct family family_3a = {.code = 0x3a, .type = "DS2413", PROPERTIES(properties)};
