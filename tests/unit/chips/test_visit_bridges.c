/* SPDX-License-Identifier: MIT */
/* No trouble, no restart and no noise makes a MAX31888 say what is not true. */
#include "tests/unit/aid/visit_group.h"

static const struct visit writes[] = {
	{0},
};

VISIT_GROUP(VISIT_BRIDGES)

int main(void)
{
	UNITY_BEGIN();
	VISIT_RUN(VISIT_BRIDGES)
	return UNITY_END();
}
