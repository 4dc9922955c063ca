/* SPDX-License-Identifier: MIT */
/*
 * The first values of thermometers, before the first search of their wire has ended.
 *
 * A search takes 23 ms for each device, and a conversion 750 ms for all. So as soon as one
 * thermometer is found on a wire, and some are asked for, all on the wire are asked for their
 * supply, and told to convert; the search goes on meanwhile. When that is over, those that were
 * asked for before are read, and all convert again for those that asked later. That concerns ids
 * that the search has not come to yet, too, on the only wire of a bus, or on the one that a short
 * search tells (guess.h): a scratchpad after Match ROM with the right checksum proves that the chip
 * is there.
 *
 * Not where a chip's scratchpad has to tell first what it is (family code 3B), on branches of
 * couplers, with drivers in place of a wire, or on wires with a parasitic thermometer. Nothing is
 * read while an alarm or an output waits for the end of the search. An output that names its device
 * by an id alone does not wait for that, nor do inputs else (first_asked.h). For others search and
 * readings take turns.
 *
 * The supply is asked for once more when the search has ended: a device that came meanwhile was
 * not asked.
 */
#pragma once

#include "hal/native/state.h"

/*
 * A step while some wire was not searched yet, or what is left to do when it was. May use the wire
 * for one transaction, for some 20 ms when conversions begin or the supply is asked for. Returns
 * whether it did something; if not, *next is when to call again at the latest.
 */
bool first_step(struct native *native, int64_t now, int64_t *next);
