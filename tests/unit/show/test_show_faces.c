/* SPDX-License-Identifier: MIT */
/* Tests of what is read of the reports of faces, whatever stands in them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/show/faces.h"

#define S INT64_C(1000000000)

static char folder[64];
static struct faces_one faces[FACES_MOST];

void setUp(void)
{
	snprintf(folder, sizeof(folder), "/tmp/owsd-faces-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
	setenv("OWS_DIR", folder, 1);
}

void tearDown(void)
{
	char command[128];

	snprintf(command, sizeof(command), "rm -r %s", folder);
	TEST_ASSERT_EQUAL_INT(0, system(command));
}

static void put(const char *name, const char *text)
{
	char path[128];
	FILE *out;

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	out = fopen(path, "w");
	TEST_ASSERT_NOT_NULL(out);
	fputs(text, out);
	fclose(out);
}

static void test_a_report_has_state_trouble_and_counters(void)
{
	put("HOUSE.owsd-mqtt",
	    "pid 7\nbeat 5000000000\nstatus publishing to a b\nsince 3\n"
	    "trouble it is lost; wait\ntroubled 7\ncount connects 2\ncount refused 0\n");
	put("HOUSE.owsd-web", "pid 8\nbeat 1\nstatus 1 streams\nloaded 4\nrefused a.rio:1:2: no\n");
	put("OTHER.owsd-web", "pid 9\nbeat 1\nstatus 1 streams\n");
	put("HOUSE.owsd-web.new", "pid 10\nbeat 1\n");
	put("HOUSE.image", "pid 11\nbeat 1\n");
	TEST_ASSERT_EQUAL_UINT(2, faces_read("HOUSE", faces));
	TEST_ASSERT_EQUAL_STRING("owsd-mqtt", faces[0].program);
	TEST_ASSERT_EQUAL_INT(7, faces[0].pid);
	TEST_ASSERT_EQUAL_STRING("publishing to a b", faces[0].status);
	TEST_ASSERT_EQUAL_STRING("it is lost; wait", faces[0].trouble);
	TEST_ASSERT_EQUAL_INT64(7, faces[0].trouble_ns);
	TEST_ASSERT_EQUAL_INT64(3, faces[0].since_ns);
	TEST_ASSERT_EQUAL_UINT(2, faces[0].count);
	TEST_ASSERT_EQUAL_STRING("connects", faces[0].counters[0].name);
	TEST_ASSERT_EQUAL_UINT64(2, faces[0].counters[0].value);
	TEST_ASSERT_EQUAL_STRING("owsd-web", faces[1].program);
	TEST_ASSERT_EQUAL_STRING("", faces[1].trouble);
	TEST_ASSERT_EQUAL_STRING("", faces[0].refused);
	TEST_ASSERT_EQUAL_STRING("a.rio:1:2: no", faces[1].refused);
	TEST_ASSERT_EQUAL_INT64(4, faces[1].loaded_ns);
	TEST_ASSERT_FALSE(faces_silent(&faces[0], 10 * S));
	TEST_ASSERT_TRUE(faces_silent(&faces[0], 30 * S));
}

static void test_what_is_no_report_disturbs_nothing(void)
{
	static char many[8192];
	size_t len = 0;

	put("HOUSE.owsd-a", "");
	put("HOUSE.owsd-b", "status no beat\n");
	put("HOUSE.owsd-c", "beat 1\nstatus a\x1b[2Jb\x9b\ncount x\ncount y -\ncount\npid\n");
	len += (size_t)snprintf(many, sizeof(many), "beat 1\nstatus %0900d\n", 0);
	for (int i = 0; i < 40; i++)
		len += (size_t)snprintf(many + len, sizeof(many) - len,
		                        "count c%d_%060d 1\ncount n%d 1\n", i, 0, i);
	put("HOUSE.owsd-d", many);
	TEST_ASSERT_EQUAL_UINT(2, faces_read("HOUSE", faces));
	TEST_ASSERT_EQUAL_STRING("a?[2Jb?", faces[0].status);
	TEST_ASSERT_EQUAL_UINT(0, faces[0].count);
	TEST_ASSERT_EQUAL_UINT(255, strlen(faces[1].status));
	TEST_ASSERT_EQUAL_UINT(FACES_COUNTERS, faces[1].count);
	TEST_ASSERT_EQUAL_UINT(0, faces_read("NOBODY", faces));
}

static void test_more_faces_than_there_are_programs_end_at_the_room(void)
{
	char name[32];

	for (int i = 0; i < FACES_MOST + 4; i++) {
		snprintf(name, sizeof(name), "HOUSE.owsd-%d", i);
		put(name, "beat 1\n");
	}
	TEST_ASSERT_EQUAL_UINT(FACES_MOST, faces_read("HOUSE", faces));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_report_has_state_trouble_and_counters);
	RUN_TEST(test_what_is_no_report_disturbs_nothing);
	RUN_TEST(test_more_faces_than_there_are_programs_end_at_the_room);
	return UNITY_END();
}
