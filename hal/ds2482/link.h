/* SPDX-License-Identifier: MIT */
/* One channel of a chip as a link. */
#ifndef HAL_DS2482_LINK_H
#define HAL_DS2482_LINK_H

struct ds2482_chip;

void ds2482_link_init(struct ds2482_chip *chip, unsigned number);

#endif
