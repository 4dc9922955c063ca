/* SPDX-License-Identifier: MIT */
/* How far wall clock and boot time are apart, and when that changes. */
#include <sys/timex.h>
#include <time.h>

#include "hal/base/time.h"
#include "src/faces/kit/wall_clock.h"

#define STEP_NS (50 * NS_PER_MS)
#define ASK_NS (10 * NS_PER_S)
#define READINGS 5

/* The reading that took the least time: others may have had the processor in between. */
static int64_t read_offset(void)
{
	int64_t best_ns = INT64_MAX, offset_ns = 0;

	for (int i = 0; i < READINGS; i++) {
		int64_t before = clock_ns(CLOCK_BOOTTIME), wall = clock_ns(CLOCK_REALTIME);
		int64_t took = clock_ns(CLOCK_BOOTTIME) - before;

		if (took < best_ns) {
			best_ns = took;
			offset_ns = wall - before - took / 2;
		}
	}
	return offset_ns;
}

static bool is_synchronised(void)
{
	struct timex t = {0};

	/* of a machine that forbids the question it is not known whether its clock is right */
	return adjtimex(&t) >= 0 && !(t.status & STA_UNSYNC);
}

void wall_clock_open(struct wall_clock *clock)
{
	*clock = (struct wall_clock){.offset_ns = read_offset(),
	                             .trusted = is_synchronised(),
	                             .asked_ns = clock_ns(CLOCK_BOOTTIME)};
}

bool wall_clock_step(struct wall_clock *clock, int64_t offset_ns, bool synchronised)
{
	int64_t moved = offset_ns - clock->offset_ns;
	bool changed = synchronised != clock->trusted;

	clock->trusted = synchronised;
	if (moved > -STEP_NS && moved < STEP_NS)
		return changed;
	clock->offset_ns = offset_ns;
	return true;
}

bool wall_clock_look(struct wall_clock *clock, int64_t now_ns)
{
	bool synchronised = clock->trusted;
	int64_t offset_ns = read_offset();

	if (now_ns - clock->asked_ns >= ASK_NS || offset_ns - clock->offset_ns >= STEP_NS ||
	    clock->offset_ns - offset_ns >= STEP_NS) {
		clock->asked_ns = now_ns;
		synchronised = is_synchronised();
	}
	return wall_clock_step(clock, offset_ns, synchronised);
}
