/* SPDX-License-Identifier: MIT */
/* Trouble on a simulated wire, at one place or at random. */
#include <stddef.h>

#include "tests/unit/aid/trouble.h"

void trouble_none(struct trouble *trouble)
{
	*trouble = (struct trouble){.random = trouble->random ? trouble->random : 1};
}

/* xorshift64*: a seed gives the same numbers everywhere. */
static bool happens(struct trouble *trouble)
{
	uint64_t x = trouble->random;

	x ^= x >> 12;
	x ^= x << 25;
	x ^= x >> 27;
	trouble->random = x;
	bool yes = (double)((x * 2685821657736338717u) >> 11) / 9007199254740992.0 <
	           trouble->probability;
	trouble->turned += yes;
	return yes;
}

bool trouble_heard(struct trouble *trouble)
{
	uint32_t reset = trouble->resets++;

	trouble->deaf = trouble->kind == TROUBLE_FALSE && reset == trouble->at;
	return !trouble->deaf;
}

bool trouble_presence(struct trouble *trouble, bool presence)
{
	uint32_t reset = trouble->resets - 1;

	if (trouble->deaf)
		return true;
	if (trouble->kind == TROUBLE_NOISE)
		return presence ^ happens(trouble);
	return presence && !(trouble->kind == TROUBLE_ABSENT && reset == trouble->at);
}

bool trouble_turns(struct trouble *trouble)
{
	uint32_t slot = trouble->slots++;

	switch (trouble->kind) {
	case TROUBLE_NONE:
	case TROUBLE_ABSENT:
	case TROUBLE_FALSE:
	case TROUBLE_RESTART:
		break;
	case TROUBLE_UNPLUG:
	case TROUBLE_SHORT:
		trouble->due = slot == trouble->at;
		break;
	case TROUBLE_TURN:
		return slot >= trouble->at && slot - trouble->at < 8 &&
		       (trouble->mask >> (slot - trouble->at) & 1);
	case TROUBLE_DEAF:
		trouble->deaf |= slot == trouble->at;
		break;
	case TROUBLE_NOISE:
		return happens(trouble);
	}
	return false;
}
