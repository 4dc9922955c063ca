/* SPDX-License-Identifier: MIT */
/* Keeps the messages of a report, and refuses a message that must not come. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/said.h"

struct config_report report;
char said[8192];

static void note(void *ctx, bool is_error, const char *message)
{
	size_t used = strlen(said);

	(void)ctx;
	TEST_ASSERT_NOT_NULL(strstr(message, is_error ? "error: " : "warning: "));
	snprintf(said + used, sizeof(said) - used, "%s\n", message);
}

static void refuse(void *ctx, bool is_error, const char *message)
{
	(void)ctx;
	(void)is_error;
	TEST_FAIL_MESSAGE(message);
}

void said_begin(void)
{
	report = (struct config_report){.line = note};
	said[0] = '\0';
}

void said_must_not_begin(void)
{
	said_begin();
	report.line = refuse;
}
