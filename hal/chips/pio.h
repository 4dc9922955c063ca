/* SPDX-License-Identifier: MIT */
/* The two open-drain switches of DS2413 (data sheet 19-5703) and DS28EA00 (19-5615). */
#ifndef HAL_CHIPS_PIO_H
#define HAL_CHIPS_PIO_H

#include "hal/chips/family.h"

/* One status nibble: pin and output latch of A, then of B; a latch of 1 does not conduct. */
int pio_read_output(struct txn *txn);  /* PIO: 1 conducts */
int pio_read_pin(struct txn *txn);     /* sensed */
int pio_read_low(struct txn *txn);     /* sensed, 1 is low */
int pio_read_state(struct txn *txn);   /* the nibble */
int pio_write_output(struct txn *txn); /* arg: the family's write command */
int pio_write_state(struct txn *txn);

/* clang-format off */
#define PIO_BITS(text, access_, command, reads, writes)                                   \
	{.name = (text), .type = PROPERTY_BITS, .life = LIFE_VOLATILE, .access = (access_), \
	 .array = {2, INDEX_LETTERS, true}, .arg = (command), .read = (reads), .write = (writes)}
/* clang-format on */

#endif
