/* SPDX-License-Identifier: MIT */
/*
 * The end of a conversion, asked by read slots. Chips take less than their longest time: genuine
 * ones some 600 of 750 ms. Behind Convert T for all, as long as nothing else was sent on the wire,
 * a read slot is low while one of them converts.
 *
 * Ones are also what one hears of chips that have lost touch with the wire meanwhile. So the answer
 * is no proof, and only a reason to read earlier: such a result is taken if it differs from the one
 * that was read last, which shows that the chip has converted since. If it does not, it is read
 * again when the longest time is over (thermometer_proof.c). No temperature comes later than it
 * would without the question. But until then the chip is locked: another request of it waits for
 * up to half of the longest time, 375 ms at 12 bits.
 *
 * Only for chips that have shown a start of theirs, with a supply, and read since the conversion
 * before. It is asked when the bus has nothing else to do, on links that count their resets.
 */
#pragma once

#include "hal/native/state.h"

/* Convert T went out for all of the channel, which take longest ns at most. */
void ending_begin(struct native *native, unsigned n, int64_t longest);
/* Ask where it is time. True: did that. *next: when to ask again. */
bool ending_step(struct native *native, int64_t now, int64_t *next);
