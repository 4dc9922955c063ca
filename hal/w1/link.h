/* SPDX-License-Identifier: MIT */
/*
 * A master of the kernel's as a link with drivers: areas of slaves that have one, raw access to
 * those that have none.
 */
#pragma once

#include "hal/wire/driver.h"

extern const struct link_ops w1_link_ops;
extern const struct link_facts w1_link_facts;
extern const struct driver_ops w1_driver_ops;
