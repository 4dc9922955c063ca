/* SPDX-License-Identifier: MIT */
/* What the id of a chip with the family code of the DS18B20 says of it (family_28.c). */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* A genuine DS18B20 has no such id. */
static inline bool clone_has_id(const uint8_t rom[8])
{
	return rom[0] == 0x28 && (rom[5] || rom[6]);
}

/* Family E, 28-00-tt-tt-ss-ss-ss: byte 6 of its scratchpad says nothing of a restart. */
static inline bool clone_hides_restart(const uint8_t rom[8])
{
	return clone_has_id(rom) && rom[1] == 0 && rom[3] != 0;
}
