/* SPDX-License-Identifier: MIT */
/* Finding a chip at an address, and setting it up. */
#pragma once

#include <stdint.h>

struct ds2482_chip;

/* Detect the part at chip->address and reset it. -ENXIO: no chip, or another part. */
int ds2482_detect(struct ds2482_chip *chip);
/*
 * Device reset and configuration of a chip that was detected: channel 0, standard speed, no pull-up
 * under way, and it is lost no more. -EIO: it does not answer as after a reset; -ETIMEDOUT: it
 * stays busy; -ENXIO: it takes no configuration, and is lost.
 */
int ds2482_setup(struct ds2482_chip *chip);
/* Write the configuration with its complement, and read it back. */
int ds2482_configure(struct ds2482_chip *chip, uint8_t config);
