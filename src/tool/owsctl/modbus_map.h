/* SPDX-License-Identifier: MIT */
/* The places of owsd-modbus, read from its files. */
#pragma once

#include "src/faces/modbus/map.h"
#include "src/tool/owsctl/ctl.h"

/*
 * As owsd-modbus starts with them: fixed, the file of the key Map, wins (NULL: the key is not
 * given); then its own in the directory (NULL: where owsd-modbus keeps it), which may be missing.
 * Returns the status, after a message.
 */
int modbus_map_given(const struct ctl *ctl, const char *fixed, const char *directory,
                     struct map *map);
