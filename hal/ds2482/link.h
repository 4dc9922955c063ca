/* SPDX-License-Identifier: MIT */
/* One channel of a chip as a link. */
#pragma once

struct ds2482_chip;

void ds2482_link_init(struct ds2482_chip *chip, unsigned number);
