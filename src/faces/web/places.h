/* SPDX-License-Identifier: MIT */
/* The addresses of Modbus that the page shows beside signals, where there is a map of them. */
#pragma once

#include "src/faces/modbus/map.h"

/* That of owsd-modbus for the instance as it is now; NULL: there is none, or it is damaged. */
const struct map *places_of(const char *instance);
const struct map *places_at(const char *path);
/* The first register of the signal with that identity; -1: it has none. Pure. */
int places_register(const struct map *map, const char *identity);
