/* SPDX-License-Identifier: MIT */
/*
 * By MQTT 3.1.1 a broker has no word for it when it closes the older one of two connections with
 * the same id. But it closes it, again and again; a broker that ends does so once, and a line that
 * breaks or a machine that restarts does not close.
 */
#include "src/faces/mqtt/taken.h"

bool taken_end(struct taken *taken, enum taken_end end, int64_t lasted_ns)
{
	bool brief = end == TAKEN_CLOSED && lasted_ns <= TAKEN_BRIEF_NS;

	taken->contested = end == TAKEN_TOLD || (taken->contested && brief);
	if (!brief)
		taken->brief = 0;
	else if (taken->brief < TAKEN_BRIEF_MOST)
		taken->brief++;
	return end == TAKEN_TOLD || taken->brief + taken->contested >= TAKEN_BRIEF_MOST;
}

void taken_proved(struct taken *taken)
{
	taken->contested = true;
	taken->brief = 0;
}

bool taken_again(const struct taken *taken)
{
	return taken->contested || taken->brief == TAKEN_BRIEF_MOST;
}
