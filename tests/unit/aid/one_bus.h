/* SPDX-License-Identifier: MIT */
/* The one bus of a test and its host: the common set-up of most tests of a bus. */
#pragma once

#include "tests/unit/aid/host.h"

extern struct host host;
extern struct bus *bus;

/* Open sim: over this scenario, on the virtual clock. */
void simulate(const char *scenario);
/* A total of the bus; fails the test when the bus has none of this name. */
uint64_t counted(const char *name);
/* Destroy the bus, if there is one. */
void one_bus_end(void);
