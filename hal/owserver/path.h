/* SPDX-License-Identifier: MIT */
/* Where the device stands in an OWFS path, which may begin with /uncached, /alarm and /bus.N. */
#ifndef HAL_OWSERVER_PATH_H
#define HAL_OWSERVER_PATH_H

#include <stdbool.h>
#include <stddef.h>

struct path_part {
	size_t at, len; /* the component, without '/' */
};

/*
 * The last component of the first len bytes of path that stands where a device does: the branches
 * of a DS2409 (main, aux) have devices below them. False: there is none (/settings/units, /bus.0).
 */
bool path_device(const char *path, size_t len, struct path_part *part);
/* "28.551DDF030000", as listings show a device that has no alias. */
bool path_is_rom_name(const char *name, size_t len);

#endif
