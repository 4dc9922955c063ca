/* SPDX-License-Identifier: MIT */
/* No trouble, restart or noise makes a sensor of Embedded Data Systems say what is not true. */
#include "tests/unit/aid/visit_group.h"

#define WRITE(kind, name, text) \
	{ \
		.chip = (kind), .property = kind "/" name, .write = (text), .stride = 3 \
	}

static const struct visit writes[] = {
	WRITE("EDS0064", "threshold/temp_hi", "33"),
	WRITE("EDS0064", "relay/control", "1"),
	WRITE("EDS0064", "alarm/clear", "1"),
	WRITE("EDS0068", "threshold/light_hi", "70000"),
	WRITE("EDS0071", "threshold/resistance_low", "99.5"),
	WRITE("EDS0080", "set_alarm/current_hi.3", "0"),
	WRITE("EDS0080", "threshold/current_low.6", "0.004"),
	WRITE("EDS0090", "output/set.BYTE", "5"),
	WRITE("EDS0090", "counter/reset.BYTE", "3"),
	WRITE("EDS0090", "latch/reset.BYTE", "255"),
	{0},
};

VISIT_GROUP(VISIT_EDS)

int main(void)
{
	UNITY_BEGIN();
	VISIT_RUN(VISIT_EDS)
	return UNITY_END();
}
