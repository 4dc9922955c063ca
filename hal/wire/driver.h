/* SPDX-License-Identifier: MIT */
/*
 * The driver contract: the kernel's drivers speak to the chips of a link in place of commands on
 * its wire. Such a link has these beside its link_ops, by which it reaches chips without a driver,
 * as far as it takes their commands.
 *
 * Blocking: a call lasts as long as the driver takes. An error is the device's, not the link's: no
 * recovery follows. A driver sees to the chips that the wire feeds. One thread: the native bus.
 */
#pragma once

#include "hal/wire/link.h"

struct area; /* hal/chips/area.h */

struct driver_ops {
	/* Has a driver this chip? */
	bool (*has)(struct link *link, const uint8_t rom[8]);
	/* Can an element (enum extension) of the property be had? Also without a driver. */
	bool (*offers)(struct link *link, const uint8_t rom[8], const char *property, int element);
	/*
	 * Bytes of an area of a chip that has a driver, from byte `at` of the area on. 0 or an
	 * error: -ENOENT nothing stands for that area, -EOPNOTSUPP or -EACCES it cannot be written.
	 */
	int (*area_read)(struct link *link, const uint8_t rom[8], const struct area *area,
	                 unsigned at, uint8_t *bytes, unsigned n);
	int (*area_write)(struct link *link, const uint8_t rom[8], const struct area *area,
	                  unsigned at, const uint8_t *bytes, unsigned n);
	/*
	 * The chip measures what a property of this name says; rom NULL: all thermometers. It is
	 * over when this returns, or when the areas that it changes are read. 0 or an error.
	 */
	int (*convert)(struct link *link, const uint8_t *rom, const char *what);
};

/* On a wire all can be had. */
static inline bool driver_offers(struct link *link, const uint8_t rom[8], const char *property,
                                 int element)
{
	return !link->driver || link->driver->offers(link, rom, property, element);
}
