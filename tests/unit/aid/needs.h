/* SPDX-License-Identifier: MIT */
/* What a test needs of the machine: without it the test is ignored, with the reason. */
#ifndef TESTS_UNIT_AID_NEEDS_H
#define TESTS_UNIT_AID_NEEDS_H

/* The test that runs ends here where there is no python3. */
void needs_python3(void);

#endif
