/* SPDX-License-Identifier: MIT */
/* The late bus: what goes wrong there is its nature, and what it has is a table. */
#include <stdio.h>

#include "tests/endurance/part.h"

static void begin(struct part *part, char *target, unsigned size)
{
	(void)part;
	snprintf(target, size, "late:seed=%u;late=24000;twice=10;up=1900000;down=7000",
	         1 + world_random(1000000));
}

static void end(struct part *part)
{
	(void)part;
}

static const char *fault(struct part *part, int64_t ns)
{
	(void)part;
	(void)ns;
	return "late";
}

static void none(struct part *part, unsigned device, bool in)
{
	(void)part;
	(void)device;
	(void)in;
}

static void restart(struct part *part, unsigned device)
{
	none(part, device, true);
}

static void pins(struct part *part)
{
	(void)part;
}

const struct part_ops part_late = {
	.name = "late",
	.age_ns = 0,
	.begin = begin,
	.end = end,
	.fault = fault,
	.plug = none,
	.restart = restart,
	.pins = pins,
};
