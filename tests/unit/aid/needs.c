/* SPDX-License-Identifier: MIT */
/* Looks for the programs of the machine that tests need. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

/* ows.py is in the build of this program: beside the folder of the unit tests. */
FILE *needs_python3_run(const char *code, const char *argument)
{
	char command[8192], here[512];
	ssize_t len = readlink("/proc/self/exe", here, sizeof(here) - 1);
	int n;

	needs_python3();
	TEST_ASSERT_GREATER_THAN(0, len);
	here[len] = '\0';
	*strrchr(here, '/') = '\0';
	n = snprintf(command, sizeof(command),
	             "PYTHONDONTWRITEBYTECODE=1 PYTHONIOENCODING=utf-8 PYTHONPATH='%s/../python' "
	             "python3 -c 'import ows, sys\n%s' %s 2>&1",
	             here, code, argument);
	TEST_ASSERT_LESS_THAN((int)sizeof(command), n);
	return popen(command, "r");
}
