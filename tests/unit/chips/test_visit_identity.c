/* SPDX-License-Identifier: MIT */
/* No trouble, restart or noise makes a chip that shares its family code say what is not true. */
#include "tests/unit/aid/visit_group.h"

static const struct visit writes[] = {
	{0},
};

VISIT_GROUP(VISIT_IDENTITY)

int main(void)
{
	UNITY_BEGIN();
	VISIT_RUN(VISIT_IDENTITY)
	return UNITY_END();
}
