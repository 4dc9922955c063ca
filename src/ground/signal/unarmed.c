/* SPDX-License-Identifier: MIT */
/* The words for what of a device's alarm is refused, or cannot be. */

#include "src/ground/signal/unarmed.h"
#include "src/public/ows.h"

static const struct {
	const char *text, *verb, *key;
} words[] = {
	[0] = {"cannot be armed", "armed", "SetAlarm"},
	[OWS_UNARMED_SET] = {"cannot be armed", "armed", "SetAlarm"},
	[OWS_UNARMED_POR] = {"cannot be armed", "armed", "PorAlarm"},
	[OWS_UNARMED_LATCH] = {"cannot be read", "read", "LatchAlarm"},
	[OWS_UNARMED_RESET] = {"cannot be reset", "reset", "ResetLatch"},
	[OWS_UNARMED_POR_READ] = {"cannot be read", "read", "PorAlarm"},
	[OWS_UNARMED_NO_POR] = {"can do nothing", "read", "PorAlarm"},
	[OWS_UNARMED_NO_LATCH] = {"can do nothing", "read", "LatchAlarm"},
	[OWS_UNARMED_STAYS] = {"not cleared by ResetLatch", "reset", "ResetLatch"},
};
#define WORDS (sizeof(words) / sizeof(words[0]))

const char *unarmed_text(uint8_t unarmed)
{
	return words[unarmed < WORDS ? unarmed : 0].text;
}

const char *unarmed_verb(uint8_t unarmed)
{
	return words[unarmed < WORDS ? unarmed : 0].verb;
}

const char *unarmed_key(uint8_t unarmed)
{
	return words[unarmed < WORDS ? unarmed : 0].key;
}
