/* SPDX-License-Identifier: MIT */
/*
 * Transactions of several chips at the same time. A chip works a byte for 0.55 ms by itself, and a
 * command takes 0.1 ms of a 400 kHz I2C bus: so while one chip works, others get their commands.
 * Nothing is read on here, because that would hold the I2C bus while a chip works: each wait is
 * slept, by the longest times of the data sheet.
 */
#pragma once

struct link;
struct link_run;

/* As link_ops.run_many and link_ops.many. */
void ds2482_together(struct link_run *runs, unsigned n);
unsigned ds2482_many(const struct link *link);
