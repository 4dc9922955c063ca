/* SPDX-License-Identifier: MIT */
/* Why the alarm of a device does not come, in words, and which key of the item it is. */
#pragma once

#include <stdint.h>

#include "src/public/ows_layout.h"

/* What the flags of a signal's attributes say of it, as enum ows_unarmed; 0: nothing fails. */
static inline uint8_t unarmed_of(uint32_t flags)
{
	if (!(flags & OWS_ATTR_ALARM_UNARMED))
		return 0;
	return (uint8_t)(1 + ((flags & OWS_ATTR_ALARM_WHY) >> OWS_ATTR_ALARM_WHY_SHIFT));
}

/*
 * unarmed: enum ows_unarmed. "cannot be armed"; "armed", "read" or "reset", what cannot be done;
 * "SetAlarm". Never NULL.
 */
const char *unarmed_text(uint8_t unarmed);
const char *unarmed_verb(uint8_t unarmed);
const char *unarmed_key(uint8_t unarmed);
