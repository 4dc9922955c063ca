/* SPDX-License-Identifier: MIT */
/*
 * A whole transaction of one chip, a reset, bytes written, bytes read, in as few I2C transfers as
 * the adapter takes (mostly two). By the data sheet of the DS2482:
 *
 *   - a command for the wire that comes while the chip works is refused, and not executed: so
 *     nothing has to be read between two of them but to pass the time;
 *   - the bits of the status that show an answer to a reset stay until the next reset: so one
 *     status, at the end, shows that and whether the chip was idle.
 *
 * How long a reset and a byte take is learnt of each chip (ends.h). The bytes that were read count
 * on the longest time of the data sheet, as nothing shows that a register was read too early.
 */
#pragma once

#include <stdbool.h>

struct ds2482_link;
struct link_part;

/* Can the adapter do that? */
bool ds2482_visits(const struct ds2482_link *link);
/* As link_ops.run, of a part with all three. Blocks for some 15 ms at 400 kHz. */
int ds2482_visit(struct ds2482_link *link, const struct link_part *part);
