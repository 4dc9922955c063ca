/* SPDX-License-Identifier: MIT */
/* Clones of the DS18B20, as far as they can be told without a command that it does not know. */
#ifndef HAL_CHIPS_CLONE_H
#define HAL_CHIPS_CLONE_H

#include <stdbool.h>
#include <stdint.h>

struct txn;

/* What a scratchpad shows; exact: it holds a result of 12 bits, not what a restart left. */
const char *clone_name(const uint8_t rom[8], const uint8_t scratchpad[9], bool exact);
/* For the property "identity" of family 28. */
int clone_read_identity(struct txn *txn);

#endif
