/* SPDX-License-Identifier: MIT */
/* Finding a chip at an address, and setting it up. */
#ifndef HAL_DS2482_DETECT_H
#define HAL_DS2482_DETECT_H

#include <stdint.h>

struct ds2482_chip;
struct ds2482_link;

/* Is a chip at chip->address? Finds its part and resets it. 0, -ENXIO nothing or another part. */
int ds2482_detect(struct ds2482_chip *chip);
/* Device reset and configuration. */
int ds2482_setup(struct ds2482_chip *chip);
/* Written, with its complement, and read back. */
int ds2482_configure(struct ds2482_chip *chip, uint8_t config);
/* Make the link's channel and speed the chip's. */
int ds2482_select(struct ds2482_link *link);

#endif
