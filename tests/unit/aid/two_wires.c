/* SPDX-License-Identifier: MIT */
/* A scene of two targets, each on a wire of its own. */
#include "tests/unit/aid/two_wires.h"

void two_wires_begin(struct scene *s)
{
	scene_init(s);
	scene_bus(s, "other", 1);
}

void two_wires_up(struct scene *s)
{
	scene_start(s);
	scene_up_on(s, 0);
	scene_up_on(s, 1);
}
