/* SPDX-License-Identifier: MIT */
/* Looks for the programs of the machine that tests need. */
#include <stdlib.h>

#include "unity.h"

#include "tests/unit/aid/needs.h"

void needs_python3(void)
{
	static int status = -1;

	if (status == -1)
		status = system("command -v python3 >/dev/null 2>&1");
	if (status != 0)
		TEST_IGNORE_MESSAGE("there is no python3");
}
