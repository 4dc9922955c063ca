/* SPDX-License-Identifier: MIT */
/* owsctl record: what the file has beside what a verb does on a wire, and when there is none. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "hal/base/time.h"
#include "hal/bus/tap.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"
#include "tests/unit/aid/caught.h"
#include "tests/unit/aid/folder.h"

#define SERIAL "551DDF030000"

static char file[300];
static bool asks; /* the verb does something */

static int64_t now(void *ctx)
{
	(void)ctx;
	return ows_now();
}

/* In place of a verb that opens a target. */
static int look(struct ctl *ctl, int argc, char **argv)
{
	const struct bus_env env = {.now = now};

	(void)argc, (void)argv;
	if (asks)
		ctl->tap->sent(ctl->tap, &env, (const uint8_t *)"/28." SERIAL, 16);
	return CTL_DONE;
}

static const struct verb *find(const char *name)
{
	static const struct verb scan = {.name = "scan", .run = look, .opens = true};
	static const struct verb list = {.name = "list", .run = look};

	return !strcmp(name, "scan") ? &scan : !strcmp(name, "list") ? &list : NULL;
}

void setUp(void)
{
	caught_begin("record");
	caught_ctl.find = find;
	caught_ctl.target = "plant.example:4304";
	asks = true;
	snprintf(file, sizeof(file), "%s", folder_file("it", "trace"));
	unlink(file);
}

void tearDown(void)
{
	caught_end();
}

static int recorded(const char *options, const char *words)
{
	char all[800];

	snprintf(all, sizeof(all), "record %s %s %s", options, file, words);
	return run(verb_record, all);
}

static const char *content(void)
{
	static char text[2000];
	FILE *made = fopen(file, "re");

	TEST_ASSERT_NOT_NULL(made);
	text[fread(text, 1, sizeof(text) - 1, made)] = '\0';
	fclose(made);
	return text;
}

static void test_the_remark_has_target_and_words(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, recorded("", "scan /28." SERIAL));
	holds(content(),
	      " -t plant.example:4304 scan /28." SERIAL "\n0.0000 0.000 net: sent \"/28.");
	holds(err, "has 1 lines\n");
	setUp();
	caught_ctl.target = NULL;
	TEST_ASSERT_EQUAL(CTL_DONE, recorded("", ""));
	holds(content(), " -t owserver scan\n");
}

/* A word with a line end would make a line that is no remark: it has an id, and it is a line. */
static void test_an_anonymous_file_has_neither_address_nor_id(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, recorded("-N", "scan /28." SERIAL "\n0 0 /28." SERIAL));
	holds(content(), " -t owserver scan /28.");
	TEST_ASSERT_NULL_MESSAGE(strstr(content(), SERIAL), content());
	TEST_ASSERT_NULL_MESSAGE(strstr(content(), "\n0 0 "), content());
	TEST_ASSERT_NULL_MESSAGE(strstr(content(), "plant"), content());
	setUp();
	TEST_ASSERT_EQUAL(CTL_USAGE, recorded("-N", "scan -t plant.example:4304"));
	holds(err, "-t stands before the file");
	TEST_ASSERT_EQUAL_INT(-1, access(file, F_OK));
}

static void test_auto_is_no_address(void)
{
	caught_ctl.target = "auto";
	TEST_ASSERT_EQUAL(CTL_DONE, recorded("-N", ""));
	holds(content(), " -t auto scan\n");
}

/* So that the same command can be given again. */
static void test_where_nothing_was_recorded_there_is_no_file(void)
{
	asks = false;
	TEST_ASSERT_EQUAL(CTL_FAILED, recorded("", ""));
	holds(err, "nothing went over a wire");
	TEST_ASSERT_EQUAL_INT(-1, access(file, F_OK));
}

static void test_what_opens_no_target_is_refused(void)
{
	TEST_ASSERT_EQUAL(CTL_USAGE, recorded("", "list"));
	TEST_ASSERT_EQUAL(CTL_USAGE, recorded("", "nothing"));
	TEST_ASSERT_EQUAL(CTL_USAGE, recorded("-N -Q", ""));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_record, "record"));
	TEST_ASSERT_EQUAL_INT(-1, access(file, F_OK));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_remark_has_target_and_words);
	RUN_TEST(test_an_anonymous_file_has_neither_address_nor_id);
	RUN_TEST(test_auto_is_no_address);
	RUN_TEST(test_where_nothing_was_recorded_there_is_no_file);
	RUN_TEST(test_what_opens_no_target_is_refused);
	return UNITY_END();
}
