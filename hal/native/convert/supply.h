/* SPDX-License-Identifier: MIT */
/* Which thermometers of a channel are fed by the wire: device.power. */
#pragma once

#include "hal/native/state.h"

/*
 * Asks all thermometers of a channel at once, some times. 1: none is fed by the wire; 0: one is, or
 * another chip made it seem so; -ENODEV no chip is there, or an error of the link.
 */
int supply_look(struct native *native, unsigned n);
/* That of all thermometers of a channel is this. */
void supply_know(struct native *native, unsigned n, enum device_power power);
/*
 * Asks all thermometers of the job's channel at once, in a transaction that counts as the job's.
 * TXN_MORE: they have been asked, and the job goes on with its next transaction. Else the error
 * that the job has.
 */
int supply_ask_all(struct native *native, struct job *job);
/*
 * Ask one thermometer that was not asked yet for its supply: the broadcast was answered with a
 * zero, by a parasitic one or by another chip to which the command means something else. A
 * thermometer that does not answer counts as parasitic, and is asked again before it converts.
 * False: all were asked.
 */
bool supply_ask_one(struct native *native, unsigned n);
