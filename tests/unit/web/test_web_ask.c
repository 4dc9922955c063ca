/* SPDX-License-Identifier: MIT */
/* Tests of what another owsd-web answers: its summary, and what is none. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/faces/web/ask.h"
#include "src/faces/web/summary.h"

#define GOOD \
	"{\"instance\":\"OWS\",\"host\":\"pi2\",\"version\":\"0.10.0\",\"first\":\"flow\"," \
	"\"alarm\":\"! high\",\"live\":true,\"signals\":9,\"not_good\":2,\"alarms\":1,\"needs\":3," \
	"\"up\":60}\n"

static struct summary summary;
static char why[ASK_WORDS];

void setUp(void)
{
}

void tearDown(void)
{
}

static bool ask(const char *status, const char *body)
{
	static char bytes[4 * ASK_MAX];
	int len = snprintf(bytes, sizeof(bytes), "HTTP/1.1 %s\r\nA: b\r\n\r\n%s", status, body);

	*why = '\0';
	return ask_parse(bytes, (size_t)len, &summary, why);
}

/* The answer with one text in place of another. */
static bool ask_with(const char *old, const char *new)
{
	char body[2000];
	const char *at = strstr(GOOD, old);

	TEST_ASSERT_NOT_NULL_MESSAGE(at, old);
	snprintf(body, sizeof(body), "%.*s%s%s", (int)(at - GOOD), GOOD, new, at + strlen(old));
	return ask("200 OK", body);
}

static void test_a_summary_is_read(void)
{
	TEST_ASSERT_TRUE(ask("200 OK", GOOD));
	TEST_ASSERT_EQUAL_STRING("pi2", summary.host);
	TEST_ASSERT_EQUAL_STRING("flow", summary.first);
	TEST_ASSERT_EQUAL_STRING("! high", summary.alarm);
	TEST_ASSERT_TRUE(summary.live);
	TEST_ASSERT_EQUAL_UINT32(9, summary.signals);
	TEST_ASSERT_EQUAL_UINT32(2, summary.not_good);
	TEST_ASSERT_EQUAL_UINT32(1, summary.alarms);
	TEST_ASSERT_EQUAL_UINT32(3, summary.needs);
	TEST_ASSERT_EQUAL_INT64(60, summary.up_s);
}

static void test_what_it_makes_it_reads(void)
{
	struct summary made = {.live = true, .signals = 3, .needs = 1, .up_s = 7};
	struct json json;
	char *text, answer[1000];
	size_t len;

	strcpy(made.instance, "B");
	strcpy(made.first, "caf\xc3\xa9 \"<b>\"");
	TEST_ASSERT_TRUE(json_start(&json, &text, &len));
	summary_json(&json, &made);
	json_finish(&json);
	snprintf(answer, sizeof(answer), "%s", text);
	free(text);
	TEST_ASSERT_TRUE(ask("200 OK", answer));
	TEST_ASSERT_EQUAL_MEMORY(&made.first, summary.first, strlen(made.first) + 1);
	TEST_ASSERT_EQUAL_STRING("", summary.host);
	TEST_ASSERT_EQUAL_INT64(7, summary.up_s);
}

static void test_an_owsd_that_never_ran_has_a_summary(void)
{
	struct summary never;

	summary_make(&never, "B", NULL, false, NULL, 0);
	TEST_ASSERT_FALSE(never.live);
	TEST_ASSERT_EQUAL_UINT32(0, never.signals);
	TEST_ASSERT_EQUAL_STRING("B", never.instance);
	TEST_ASSERT_EQUAL_INT64(-1, never.up_s);
}

static void test_members_of_a_later_version_are_passed_over(void)
{
	TEST_ASSERT_TRUE(ask_with("{", "{\"more\":1,\"and\":\"x\",\"yet\":null,"));
}

static void test_fields_that_cannot_be_refuse_it_all(void)
{
	static const char *const cases[][2] = {
		{"\"signals\":9", "\"signals\":-9"},
		{"\"signals\":9", "\"signals\":9.5"},
		{"\"signals\":9", "\"signals\":9e9"},
		{"\"signals\":9", "\"signals\":99999999999999999999"},
		{"\"signals\":9", "\"signals\":\"9\""},
		{"\"signals\":9,", ""},
		{"\"signals\":9", "\"signals\":2"},
		{"\"needs\":3", "\"needs\":10"},
		{"\"alarms\":1", "\"alarms\":10"},
		{"\"live\":true", "\"live\":1"},
		{"\"live\":true,", ""},
		{"\"up\":60", "\"up\":-60"},
		{"\"up\":60", "\"up\":\"<b>\""},
		{"\"host\":\"pi2\"", "\"host\":7"},
		{"\"host\":\"pi2\"", "\"host\":{}"},
		{"\"host\":\"pi2\"", "\"host\":\"a\\u0007b\""},
		{"\"host\":\"pi2\"", "\"host\":\"a\\u202eb\""},
		{"\"host\":\"pi2\"", "\"host\":\"a\\nb\""},
		{"\"host\":\"pi2\"", "\"host\":\"a\xff\""},
		{"\"alarm\":\"! high\"",
	         "\"alarm\":\"0123456789012345678901234567890123456789012345678901234567890123\""},
		{"{", "[{"},
		{"}", ""},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		TEST_ASSERT_FALSE_MESSAGE(ask_with(cases[i][0], cases[i][1]), cases[i][1]);
		TEST_ASSERT_EQUAL_STRING("its answer is no summary of an owsd-web", why);
	}
}

static void test_no_word_of_the_answer_is_shown_where_it_is_no_summary(void)
{
	static const struct {
		const char *status, *word;
	} cases[] = {
		{"302 <b>", "leads elsewhere"},
		{"401 no", "password"},
		{"403 no", "proxy"},
		{"404 no", "no owsd-web"},
		{"421 no", "Hosts"},
		{"500 <script>", "status 500"},
		{"20 OK", "HTTP"},
		{"abc <b>", "HTTP"},
		{"200 OK", "no summary"},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		TEST_ASSERT_FALSE(ask(cases[i].status, "<script>"));
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, cases[i].word), why);
		TEST_ASSERT_NULL(strchr(why, '<'));
	}
}

static void test_each_cut_of_an_answer_is_refused(void)
{
	static const char whole[] = "HTTP/1.0 200 OK\r\nA: b\r\n\r\n" GOOD;
	char bytes[sizeof(whole)];

	for (size_t len = 0; len < sizeof(whole) - 3; len++) {
		memcpy(bytes, whole, len);
		TEST_ASSERT_FALSE(ask_parse(bytes, len, &summary, why));
	}
	memcpy(bytes, whole, sizeof(whole));
	TEST_ASSERT_TRUE(ask_parse(bytes, sizeof(whole) - 1, &summary, why));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_summary_is_read);
	RUN_TEST(test_what_it_makes_it_reads);
	RUN_TEST(test_an_owsd_that_never_ran_has_a_summary);
	RUN_TEST(test_members_of_a_later_version_are_passed_over);
	RUN_TEST(test_fields_that_cannot_be_refuse_it_all);
	RUN_TEST(test_no_word_of_the_answer_is_shown_where_it_is_no_summary);
	RUN_TEST(test_each_cut_of_an_answer_is_refused);
	return UNITY_END();
}
