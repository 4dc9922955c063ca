/* SPDX-License-Identifier: MIT */
/* What is known of a thermometer with a nine-byte scratchpad: this part alone has it. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "hal/wire/device.h"

/* Does byte 6 of a scratchpad follow the temperature, as in the genuine chip? */
enum thermometer_make { MAKE_UNKNOWN, MAKE_GENUINE, MAKE_CLONE };

/* What is known of the chip (device.own). */
struct thermometer {
	/* For good. */
	uint8_t make;    /* enum thermometer_make */
	bool ignores;    /* takes no other resolution (clones) */
	bool only_12;    /* has one resolution, and no bits that say so */
	uint8_t refused; /* so often in a row it kept the one it had */
	/* Until it restarts. */
	uint8_t resolution;   /* 9 to 12 as read back; 0: not known */
	uint8_t stored;       /* what it was before our first change: the EEPROM's; 0: not known */
	bool slow;            /* a lower resolution may not make it quicker (clones) */
	uint8_t unheard;      /* starts in a row that it did not show */
	bool shows;           /* it has shown a start */
	bool tried;           /* it may have converted since, though it did not show the start */
	bool proves;          /* the result before the last conversion is what was read last */
	bool unseen;          /* the chip could not show that its last conversion began */
	bool coarse;          /* it may hold a result at fewer bits than it is to have */
	bool recalled;        /* its EEPROM was recalled: `stored` is what stands there */
	uint8_t latched_bits; /* the resolution that `latched` was to have; 0: not known */
	uint8_t latched[3];   /* what tells one conversion's result from another's, when read */
	int16_t raw;          /* last good reading, sixteenths of a degree */
	int32_t longest_ns;   /* how long after its start its last conversion ends */
	int64_t raw_ns;       /* when `raw` was read; 0: never */
	int64_t converted_ns; /* when its last conversion ends or ended; 0: none known */
	int64_t busy_ns;      /* until then it may convert, whatever it heard */
	int64_t least_ns;     /* no conversion that it may be at work with ends earlier */
	int64_t early_ns;     /* it seemed to end then, which is not proven; 0: it did not */
	int64_t unread_ns;    /* the one whose result did not come over the wire whole; 0: none */
	int64_t earlier_ns;   /* the one before the last */
	int64_t since_ns;     /* the first that it may have made since raw_ns; 0: none */
	int64_t latched_ns;   /* of which conversion `latched` was; 0: not known */
};
_Static_assert(sizeof(struct thermometer) <= DEVICE_OWN, "no room for what is known");
static inline struct thermometer *thermometer_of(const struct device *device)
{
	return device->own;
}

/* Of the family code of the DS18B20 (family_28.c): a genuine one has no such id. */
static inline bool clone_has_id(const uint8_t rom[8])
{
	return rom[0] == 0x28 && (rom[5] || rom[6]);
}

/* Family E, 28-00-tt-tt-ss-ss-ss: byte 6 of its scratchpad says nothing of a restart. */
static inline bool clone_hides_restart(const uint8_t rom[8])
{
	return clone_has_id(rom) && rom[1] == 0 && rom[3] != 0;
}
