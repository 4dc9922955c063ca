/* SPDX-License-Identifier: MIT */
/* No logger is given the time of a computer that does not know the time. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"

static time_t host_says;
static char place[] = "/tmp/owsctl-mission-XXXXXX", scenario[80], target[100];

/* In place of the C library's. */
time_t time(time_t *out)
{
	if (out)
		*out = host_says;
	return host_says;
}

void setUp(void)
{
	static const char wire[] = "chip DS2482-100 0x18\n"
				   "DS1923 41.000000000001\nDS1921G 21.000000000001\n";

	strcpy(place + sizeof(place) - 7, "XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(place));
	snprintf(scenario, sizeof(scenario), "%s/one.sim", place);
	snprintf(target, sizeof(target), "sim:%s", scenario);
	FILE *file = fopen(scenario, "w");
	TEST_ASSERT_NOT_NULL(file);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, fputs(wire, file));
	TEST_ASSERT_EQUAL_INT(0, fclose(file));
}

void tearDown(void)
{
	unlink(scenario);
	rmdir(place);
}

static int start(const char *device)
{
	static char name[20];
	char verb[] = "mission", what[] = "start", option[] = "-i", seconds[] = "60";
	char *words[] = {verb, option, seconds, what, name, NULL};
	static const struct verb mission = {.name = "mission", .run = verb_mission, .opens = true};
	struct ctl ctl = {.instance = "owsd", .target = target, .verb = &mission};

	snprintf(name, sizeof(name), "%s", device);
	return ctl_run(&ctl, 5, words);
}

static void test_a_mission_starts_only_where_the_time_is_known(void)
{
	static const char *const loggers[] = {"41.000000000001", "21.000000000001"};

	for (unsigned i = 0; i < 2; i++) {
		host_says = 1800000000;
		TEST_ASSERT_EQUAL_INT_MESSAGE(CTL_DONE, start(loggers[i]), loggers[i]);
		host_says = 1000;
		TEST_ASSERT_EQUAL_INT_MESSAGE(CTL_FAILED, start(loggers[i]), loggers[i]);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_mission_starts_only_where_the_time_is_known);
	return UNITY_END();
}
