/* SPDX-License-Identifier: MIT */
/*
 * The trial of a thermometer: does its scratchpad keep the last result while it converts anew, and
 * for how long? One chip of the bus at a time, with an external supply, of which results are asked
 * for. A part takes about a second, in which the chip is locked:
 *
 *   supply, 9 bits, Convert T, read; 12 bits: the scratchpad has the result of 9 bits now;
 *   Convert T; read the nine bytes at eight points; read the result of 12 bits, which has to differ
 *
 * Two parts find when the chip begins to show the new result; the time before that is its shortest.
 * In four more all of the eight points, up to four fifths of that time, have to show the old nine
 * bytes. What else they show refuses the chip until it restarts. A part that shows nothing, as the
 * two results are the same or the wire was disturbed, is made again.
 *
 * No command is sent but those of the data sheet (19-7487), and nothing reaches the EEPROM.
 */
#ifndef HAL_NATIVE_TRIAL_H
#define HAL_NATIVE_TRIAL_H

#include "hal/native/state.h"

/* Is the option on, and the channel a wire of its own whose slots this bus makes? */
bool trial_fits(const struct native *native, unsigned n);
/* Has no other channel of the bus a thermometer? */
bool trial_alone(const struct native *native, unsigned n);
/* Do a transaction of a trial, if one is due. True: did it. *next: when the next one is. */
bool trial_step(struct native *native, int64_t now, int64_t *next);
/* Is a trial of a chip of this channel under way, or soon? */
bool trial_waits(const struct native *native, unsigned n, int64_t now);
/* The chip has shown something that does not fit: its results are read late from now on. */
void trial_doubt(struct native *native, struct device *device, const char *why);

#endif
