/* SPDX-License-Identifier: MIT */
/* The words for what of a device's alarm is refused. */

#include "src/signal/unarmed.h"
#include "src/libows/ows.h"

static const struct {
	const char *verb, *key;
} words[] = {
	[OWS_UNARMED_SET] = {"armed", "SetAlarm"},
	[OWS_UNARMED_POR] = {"armed", "PorAlarm"},
	[OWS_UNARMED_LATCH] = {"read", "LatchAlarm"},
	[OWS_UNARMED_RESET] = {"reset", "ResetLatch"},
	[OWS_UNARMED_POR_READ] = {"read", "PorAlarm"},
};
#define WORDS (sizeof(words) / sizeof(words[0]))

const char *unarmed_verb(uint8_t unarmed)
{
	return unarmed < WORDS && words[unarmed].verb ? words[unarmed].verb : "armed";
}

const char *unarmed_key(uint8_t unarmed)
{
	return unarmed < WORDS && words[unarmed].key ? words[unarmed].key : "SetAlarm";
}
