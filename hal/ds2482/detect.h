/* SPDX-License-Identifier: MIT */
/* Finding a chip at an address, and setting it up. */
#ifndef HAL_DS2482_DETECT_H
#define HAL_DS2482_DETECT_H

#include <stdbool.h>
#include <stdint.h>

struct ds2482_chip;
struct ds2482_link;

/* Detect the part at chip->address and reset it. -ENXIO: no chip, or another part. */
int ds2482_detect(struct ds2482_chip *chip);
/* Device reset and configuration. */
int ds2482_setup(struct ds2482_chip *chip);
/* Write the configuration with its complement, and read it back. */
int ds2482_configure(struct ds2482_chip *chip, uint8_t config);
/* Select the channel of the link, and set its speed. */
int ds2482_select(struct ds2482_link *link);
/*
 * Before a transaction: is the chip still ours? Asked of the kernel now and then. false: the chip
 * is lost.
 */
bool ds2482_claimed(struct ds2482_chip *chip);
/* A 1-Wire command has begun: it ends the strong pull-up and clears its bit. */
void ds2482_began(struct ds2482_chip *chip);

#endif
