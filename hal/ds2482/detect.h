/* SPDX-License-Identifier: MIT */
/* Finding a chip at an address, and setting it up. */
#pragma once

#include <stdint.h>

struct ds2482_chip;

/* Detect the part at chip->address and reset it. -ENXIO: no chip, or another part. */
int ds2482_detect(struct ds2482_chip *chip);
/* Device reset and configuration. */
int ds2482_setup(struct ds2482_chip *chip);
/* Write the configuration with its complement, and read it back. */
int ds2482_configure(struct ds2482_chip *chip, uint8_t config);
