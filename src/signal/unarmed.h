/* SPDX-License-Identifier: MIT */
/* Why the alarm of a device does not come: what cannot be done, and which key of the item it is. */
#pragma once

#include <stdint.h>

/* unarmed: enum ows_unarmed. "armed", "read" or "reset"; "SetAlarm". Never NULL. */
const char *unarmed_verb(uint8_t unarmed);
const char *unarmed_key(uint8_t unarmed);
