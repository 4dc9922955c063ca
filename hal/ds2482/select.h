/* SPDX-License-Identifier: MIT */
/* What precedes an operation on a link, and what its beginning changes in the chip. */
#pragma once

#include <stdbool.h>

struct ds2482_chip;
struct ds2482_link;

/* Select the channel of the link. */
int ds2482_select(struct ds2482_link *link);
/*
 * Before a transaction: is the chip still ours? Asked of the kernel now and then. false: the chip
 * is lost.
 */
bool ds2482_claimed(struct ds2482_chip *chip);
/* 0, also if it is not on, or an error. */
int ds2482_end_strong(struct ds2482_chip *chip);
/* A 1-Wire command has begun: it ends the strong pull-up and clears its bit. */
void ds2482_began(struct ds2482_chip *chip);
/* Of the status after a reset, which is counted: 0 a chip answered, -EHOSTDOWN none did, -ECOMM. */
int ds2482_presence(struct ds2482_link *link, int status);
