/* SPDX-License-Identifier: MIT */
/* What a test needs of the machine: without it the test is ignored, with the reason. */
#pragma once

#include <stdio.h>

/* The test that runs ends here where there is no python3. */
void needs_python3(void);
/* Start python3 with "import ows, sys" and code without a '. sys.argv[1] is the argument. */
FILE *needs_python3_run(const char *code, const char *argument);
