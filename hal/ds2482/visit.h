/* SPDX-License-Identifier: MIT */
/*
 * Bytes written and read, and whole transactions, in as few I2C transfers as the adapter takes
 * (mostly two for a reading). By the data sheet of the DS2482:
 *
 *   - a command for the wire that comes while the chip works is refused, and not executed: so
 *     nothing has to be read between two of them but to pass the time;
 *   - the bits of the status that show an answer to a reset stay until the next reset: so one
 *     status, at the end, shows that and whether the chip was idle.
 *
 * How long a reset and a byte take is learnt of each chip (ends.h), and used where bytes that are
 * read show that all was taken. The bytes that were read count on the longest time of the data
 * sheet, as nothing shows that a register was read too early.
 */
#pragma once

#include <stdbool.h>

struct ds2482_chip;
struct link_part;

/* Does the adapter make a whole transaction? Else its reset is one for itself. */
bool ds2482_visits(const struct ds2482_chip *chip);
/*
 * What a part writes and reads, with its reset if it is a whole transaction: 0 or more, the status
 * at its end where the adapter reads one; or an error. `after` is LINK_IDLE. Blocks for some 15 ms
 * at 400 kHz.
 */
int ds2482_visit(struct ds2482_chip *chip, const struct link_part *part);
