/* SPDX-License-Identifier: MIT */
/* Why the alarm of a device does not come, in words, and which key of the item it is. */
#pragma once

#include <stdint.h>

/*
 * unarmed: enum ows_unarmed. "cannot be armed"; "armed", "read" or "reset", what cannot be done;
 * "SetAlarm". Never NULL.
 */
const char *unarmed_text(uint8_t unarmed);
const char *unarmed_verb(uint8_t unarmed);
const char *unarmed_key(uint8_t unarmed);
