/* SPDX-License-Identifier: MIT */
/* What the sensors of Embedded Data Systems have in common: areas, and ways that no field has. */
#pragma once

#include "hal/chips/area.h"

/* Which sensor it is (device.kind). */
enum eds_kind {
	EDS0064 = 1,
	EDS0065,
	EDS0066,
	EDS0067,
	EDS0068,
	EDS0070,
	EDS0071,
	EDS0072,
	EDS0080,
	EDS0082,
	EDS0083,
	EDS0085,
	EDS0090,
	EDS_OTHER, /* has the common properties */
	EDS_KINDS,
};

/* All pages; and of the EDS0090 what can be written. */
extern const struct area eds_memory, eds_switches;
enum { EDS_SWITCHES_AT = 0x50 };

/* family.identify */
int eds_identify(struct txn *txn);
int eds_read_tag(struct txn *txn);
int eds_read_type(struct txn *txn);
int eds_write_memory(struct txn *txn);
/* Every second bit, from .shift on: the flags of high and low limits take turns. */
int eds_read_pairs(struct txn *txn);
int eds_write_pairs(struct txn *txn);
/* Relay and LED: the register is heeded only if they are not left to the alarms. */
int eds_write_state(struct txn *txn);
/* Of the EDS0090: counters and latches. */
int eds_write_reset(struct txn *txn);
int eds_write_clear(struct txn *txn);
