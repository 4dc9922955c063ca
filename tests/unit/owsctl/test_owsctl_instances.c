/* SPDX-License-Identifier: MIT */
/* The state of an instance from what is seen of it; the configuration of a command line. */
#include <string.h>

#include "unity.h"

#include "src/tool/owsctl/running.h"

void setUp(void)
{
}

void tearDown(void)
{
}

enum { LIVE = 1, RETIRED = 2, STOPPED = 3, ABSENT = -2, DENIED = -13, LOST = -116 };

static void test_the_state_follows_from_image_heart_and_lock(void)
{
	static const struct {
		bool has_image;
		uint32_t state;
		bool alive;
		int lock;
		bool process;
		enum instance_state expected;
	} rows[] = {
		{true, LIVE, true, 1, true, INSTANCE_RUNNING},
		{true, LIVE, true, DENIED, false, INSTANCE_RUNNING},
		{true, LIVE, true, ABSENT, true, INSTANCE_RUNNING}, /* somebody removed the lock */
		{true, LIVE, true, 0, true, INSTANCE_KILLED},       /* just now */
		{true, LIVE, true, LOST, false, INSTANCE_RUNNING},
		{true, LIVE, false, LOST, true, INSTANCE_HANGS},
		{true, LIVE, false, LOST, false, INSTANCE_KILLED},
		{true, LIVE, false, 1, true, INSTANCE_HANGS},
		{true, LIVE, false, 0, true, INSTANCE_KILLED}, /* another owsd got its number */
		{true, LIVE, false, 0, false, INSTANCE_KILLED},
		{true, LIVE, false, DENIED, true, INSTANCE_HANGS},
		{true, LIVE, false, DENIED, false, INSTANCE_KILLED},
		{true, STOPPED, false, 0, false, INSTANCE_STOPPED},
		{true, RETIRED, false, 0, false, INSTANCE_KILLED},
		{false, 0, false, 1, true, INSTANCE_HIDDEN},
		{false, 0, false, 0, false, INSTANCE_LEFT},
		{false, 0, false, DENIED, false, INSTANCE_LEFT},
		{false, 0, false, ABSENT, false, INSTANCE_LEFT},
	};

	for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		enum instance_state state = instance_state_of(rows[i].has_image, rows[i].state,
		                                              rows[i].alive, rows[i].lock,
		                                              rows[i].process);

		TEST_ASSERT_EQUAL_STRING(instance_state_text(rows[i].expected),
		                         instance_state_text(state));
	}
}

static void test_the_configuration_stands_in_the_command_line(void)
{
	static const struct {
		const char *line; /* words end in '|' */
		const char *expected;
	} rows[] = {
		{"owsd|-c|plant.rio|", "plant.rio"},
		{"owsd|-n|X|-cplant.rio|", "plant.rio"},
		{"owsd|--config|/etc/a b.rio|-v|", "/etc/a b.rio"},
		{"owsd|--config=plant.rio|", "plant.rio"},
		{"owsd|-c|a|-c|b|", "b"},
		{"-c|x|", NULL},
		{"owsd|-t|sim:x|", NULL},
		{"owsd|-c|", NULL},
		{"owsd|-c", NULL}, /* cut */
		{"", NULL},
	};
	char line[80];

	for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		size_t len = strlen(rows[i].line);
		const char *found;

		memcpy(line, rows[i].line, len + 1);
		for (size_t k = 0; k < len; k++)
			if (line[k] == '|')
				line[k] = '\0';
		found = instance_config_of(line, len);
		if (rows[i].expected)
			TEST_ASSERT_EQUAL_STRING(rows[i].expected, found);
		else
			TEST_ASSERT_NULL(found);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_state_follows_from_image_heart_and_lock);
	RUN_TEST(test_the_configuration_stands_in_the_command_line);
	return UNITY_END();
}
