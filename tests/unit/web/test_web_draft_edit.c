/* SPDX-License-Identifier: MIT */
/* Tests of the edits of a draft, of its model and of its problems, as JSON. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/faces/web/draft_edit.h"
#include "src/faces/web/model.h"
#include "src/faces/web/problems.h"

static struct problems problems;
static struct config_report report;
static struct rio *rio;
static char *shown;

void setUp(void)
{
	report = problems_report(&problems);
	shown = NULL;
}

void tearDown(void)
{
	problems_free(&problems);
	rio_free(rio);
	rio = NULL;
	free(shown);
}

static const char house[] =
	"OwsDrv {\n"
	"  TargetName \"sim:a, b | c ,\"\n"
	"  ControlAllow \"x: y\" ControlAllow \"z: y\"\n"
	"  Item { Name \"a\\\"\" Path /uncached/28551ddf030000/power IOType 0x121 }\n"
	"  Item { Name b Path /alias/power Type word Uncached on }\n"
	"}\n";

static void parse(const char *text)
{
	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", text, strlen(text), &report, &rio));
}

static int edit(const char *body_text)
{
	static char bytes[1024];
	struct body body;

	snprintf(bytes, sizeof(bytes), "%s", body_text);
	TEST_ASSERT_EQUAL_INT(0, body_parse(bytes, strlen(bytes), &body));
	return draft_edit(&rio, &body, &report);
}

static void show(void (*put)(struct json *, const struct rio *))
{
	size_t len;
	FILE *out = open_memstream(&shown, &len);
	struct json json;

	json_open(&json, out);
	json_object(&json, NULL);
	put(&json, rio);
	json_object_end(&json);
	fclose(out);
}

static void has(const char *piece)
{
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(shown, piece), shown);
}

static void test_the_model_has_what_stands_in_the_text(void)
{
	parse(house);
	show(model_json);
	has("\"targets\":[\"sim:a\",\"b\",\"c\"]");
	has("\"ControlAllow\":\"x: y\"}");
	has("\"name\":\"a\\\"\",\"path\":\"/uncached/28551ddf030000/power\","
	    "\"device\":\"28.551DDF030000\",\"line\":4,\"type\":\"bool\","
	    "\"io\":\"output\",\"uncached\":true,\"keys\":{\"IOType\":\"0x121\"}");
	has("\"device\":null,\"line\":5,\"type\":\"word\",\"io\":\"input\","
	    "\"uncached\":true,\"keys\":{\"Type\":\"word\",\"Uncached\":\"on\"}");
}

static void test_zeros_in_front_make_no_octal_number_of_io_type(void)
{
	parse("OwsDrv {\n  Item { Name a Path /b/c IOType 0034 Uncached yes }\n}\n");
	show(model_json);
	has("\"type\":\"byte\",\"io\":\"output\",\"uncached\":true,");
}

static void test_a_text_without_a_driver_has_an_empty_model(void)
{
	parse("");
	show(model_json);
	TEST_ASSERT_EQUAL_STRING("{\"model\":{\"targets\":[],\"driver\":{},\"blocks\":{},"
	                         "\"buses\":[],\"items\":[]}}",
	                         shown);
}

static void test_of_a_key_that_stands_twice_the_first_counts(void)
{
	parse("OwsDrv {\n  z 1\n  b 2\n  z 3\n  a 4\n  Web { }\n  Web { Write on }\n}\n");
	show(model_json);
	has("\"driver\":{\"z\":\"1\",\"b\":\"2\",\"a\":\"4\"},\"blocks\":{\"Web\":{}}");
}

static unsigned long compared;

/* In the place of libc's: the compares of keys are the steps of a search. */
int strcmp(const char *a, const char *b)
{
	compared++;
	while (*a && *a == *b) {
		a++;
		b++;
	}
	return (unsigned char)*a - (unsigned char)*b;
}

/* A megabyte of them, which nobody may use to hold up the others for minutes. */
static void test_a_hundred_thousand_keys_take_the_steps_of_a_sort(void)
{
	enum { MANY = 100000 };
	size_t len;
	char *text;
	FILE *out = open_memstream(&text, &len);

	fputs("OwsDrv {\n", out);
	for (int i = 0; i < MANY; i++)
		fprintf(out, "k%x 1\n", i);
	fputs("}\n", out);
	fclose(out);
	parse(text);
	free(text);
	compared = 0;
	show(model_json);
	/* a search through all compares 50000 times for each key, a sort 17 times */
	TEST_ASSERT_GREATER_THAN(10 * MANY, compared);
	TEST_ASSERT_LESS_THAN(100 * MANY, compared);
	has("\"k1869f\":\"1\"");
}

static void test_edits_in_a_row_stand_in_lines_and_the_first_that_is_refused_ends_them(void)
{
	parse(house);
	TEST_ASSERT_EQUAL_INT(
		0, edit("{\"do\":\"steps\",\"steps\":\"{\\\"do\\\":\\\"set\\\",\\\"name\\\":"
	                "\\\"b\\\",\\\"keys\\\":\\\"Unit=K\\\"}\\n{\\\"do\\\":\\\"remove\\\","
	                "\\\"name\\\":\\\"a\\\\\\\"\\\"}\"}"));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "Unit"));
	TEST_ASSERT_NULL(strstr(rio->text, "28551ddf030000"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit("{\"do\":\"steps\",\"steps\":\"no\"}"));
	TEST_ASSERT_EQUAL_INT(-EINVAL,
	                      edit("{\"do\":\"steps\",\"steps\":\"{\\\"do\\\":\\\"remove\\\","
	                           "\\\"name\\\":\\\"c\\\"}\\n{\\\"do\\\":\\\"remove\\\","
	                           "\\\"name\\\":\\\"b\\\"}\"}"));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "Name b"));
}

static void test_settings_stand_in_lines(void)
{
	parse(house);
	TEST_ASSERT_EQUAL_INT(0, edit("{\"do\":\"set\",\"name\":\"b\","
	                              "\"keys\":\"Unit=a=b\\n\\nType=byte\\n\"}"));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "Type byte"));
	TEST_ASSERT_NOT_NULL(strstr(rio->text, "\"a=b\""));
	TEST_ASSERT_EQUAL_INT(0, edit("{\"do\":\"new\"}"));
	TEST_ASSERT_NULL(strstr(rio->text, "Item {"));
}

static void test_too_many_settings_are_refused(void)
{
	char text[1024] = "{\"do\":\"unset\",\"name\":\"b\",\"keys\":\"";
	int line;

	parse(house);
	for (int i = 0; i <= DRAFT_SETTINGS; i++)
		strcat(text, "Unit\\n");
	strcat(text, "\"}");
	TEST_ASSERT_EQUAL_INT(-EINVAL, edit(text));
	TEST_ASSERT_EQUAL_STRING("too many keys for one edit", problems_first(&problems, &line));
}

static void show_problems(struct json *json, const struct rio *of)
{
	problems_json(json, &problems, of);
}

static void test_a_problem_knows_what_stands_at_its_place(void)
{
	parse(house);
	report_error(&report, (struct rio_position){"f", 4, 0}, "line");
	report_warning(&report, (struct rio_position){"f", 5, 45}, "key");
	report_error(&report, (struct rio_position){"f", 0, 0}, "whole");
	report_error(&report, (struct rio_position){"f", 2, 14}, "driver");
	report_error(&report, (struct rio_position){"f", 99, 99}, "beyond");
	show(show_problems);
	has("{\"error\":true,\"line\":4,\"column\":0,\"text\":\"line\",\"item\":\"a\\\"\","
	    "\"block\":null,\"key\":null}");
	has("{\"error\":false,\"line\":5,\"column\":45,\"text\":\"key\",\"item\":\"b\","
	    "\"block\":null,\"key\":\"Uncached\"}");
	has("\"text\":\"whole\",\"item\":null,\"block\":null,\"key\":null}");
	has("\"text\":\"driver\",\"item\":null,\"block\":\"OwsDrv\",\"key\":\"TargetName\"}");
	has("\"text\":\"beyond\",\"item\":null,\"block\":null,\"key\":null}");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_model_has_what_stands_in_the_text);
	RUN_TEST(test_zeros_in_front_make_no_octal_number_of_io_type);
	RUN_TEST(test_a_text_without_a_driver_has_an_empty_model);
	RUN_TEST(test_of_a_key_that_stands_twice_the_first_counts);
	RUN_TEST(test_a_hundred_thousand_keys_take_the_steps_of_a_sort);
	RUN_TEST(test_edits_in_a_row_stand_in_lines_and_the_first_that_is_refused_ends_them);
	RUN_TEST(test_settings_stand_in_lines);
	RUN_TEST(test_too_many_settings_are_refused);
	RUN_TEST(test_a_problem_knows_what_stands_at_its_place);
	return UNITY_END();
}
