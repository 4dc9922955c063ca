/* SPDX-License-Identifier: MIT */
/* Which thermometers of a channel are fed by the wire: device.power. */
#ifndef HAL_NATIVE_SUPPLY_H
#define HAL_NATIVE_SUPPLY_H

#include "hal/native/state.h"

/* Asks all at once, as the job's transaction. TXN_MORE: done; or the job's error. */
int supply_ask_all(struct native *native, struct job *job);
/*
 * Ask one thermometer for its supply that nobody asked yet: the broadcast was answered with a zero,
 * by a parasitic one or by another chip to which the command means something else. Who does not
 * answer counts as parasitic. False: all are known.
 */
bool supply_ask_one(struct native *native, unsigned n);

#endif
