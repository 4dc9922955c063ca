/* SPDX-License-Identifier: MIT */
/* Tests of the words of owsd-notify: what stands in a name or a description makes no header. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/faces/notify/message.h"

static struct entry entry;
static struct ows_info info;
static const struct when now = {.boot = 1000 * NS_PER_S, .wall = 1700000000 * NS_PER_S};
static char *text;
static size_t len;

void setUp(void)
{
	setenv("TZ", "UTC", 1);
	entry = (struct entry){0};
	info = (struct ows_info){.name = "freezer",
	                         .unit = "°C",
	                         .description = "In the cellar",
	                         .family = "",
	                         .device = "",
	                         .group = "",
	                         .decimals = 1,
	                         .limit_hh = NAN,
	                         .limit_h = 30,
	                         .limit_l = NAN,
	                         .limit_ll = -30};
}

void tearDown(void)
{
	free(text);
	text = NULL;
}

static const struct ows_alarm low = {.kind = OWS_ALARM_LL,
                                     .event = OWS_ALARM_RAISED,
                                     .occurred_ns = 999 * NS_PER_S,
                                     .after = -40.26,
                                     .has_after = 1,
                                     .type = OWS_DOUBLE,
                                     .quality = OWS_Q_GOOD};

static void test_an_alarm_has_value_limit_time_and_what_it_is(void)
{
	message_alarm(&entry, &info, &low, &now);
	TEST_ASSERT_EQUAL_STRING("freezer low low: -40.3 °C; 10.3 °C below LimitLL -30 °C; since "
	                         "2023-11-14T22:13:19; In the cellar",
	                         entry.text);
	TEST_ASSERT_EQUAL_INT64(low.occurred_ns, entry.entered_ns);
	TEST_ASSERT_EQUAL_UINT(strlen("freezer low low: -40.3 °C"), entry.head);
}

static void test_an_alarm_that_is_bad_has_no_number(void)
{
	struct ows_alarm bad = low;

	bad.kind = OWS_ALARM_BAD;
	bad.quality = OWS_Q_NO_DEVICE;
	info.description = "";
	message_alarm(&entry, &info, &bad, &now);
	TEST_ASSERT_EQUAL_STRING("freezer bad: device absent; since 2023-11-14T22:13:19; The "
	                         "device does not answer on its wire. Does \"owsctl scan\" list "
	                         "the id? Compare it with the path. Check ground, data and the "
	                         "pull-up.",
	                         entry.text);
}

static void test_one_that_is_back_says_so(void)
{
	struct ows_alarm back = low;

	back.event = OWS_ALARM_RETURNED;
	back.after = -20;
	message_alarm(&entry, &info, &back, &now);
	TEST_ASSERT_EQUAL_STRING(
		"freezer no longer low low: -20 °C; at 2023-11-14T22:13:19; In the cellar",
		entry.text);
}

static void test_an_alarm_of_a_device_says_where_it_is_what_it_means_and_what_to_do(void)
{
	struct ows_alarm own = {.kind = OWS_ALARM_DEVICE,
	                        .event = OWS_ALARM_RAISED,
	                        .occurred_ns = 999 * NS_PER_S,
	                        .after_integer = 1,
	                        .has_after = 1,
	                        .type = OWS_BOOL,
	                        .quality = OWS_Q_GOOD,
	                        .text = "2"};

	info = (struct ows_info){.name = "door",
	                         .unit = "",
	                         .family = "DS2406",
	                         .device = "12.000000000001",
	                         .group = "Entrance",
	                         .description = "Behind the shed"};
	message_alarm(&entry, &info, &own, &now);
	TEST_ASSERT_EQUAL_STRING(
		"door device alarm: 1; its latch reads 2; since 2023-11-14T22:13:19; DS2406 "
		"12.000000000001; Entrance; Behind the shed; What the device watches has "
		"happened. Look at what it watches. The alarm ends when owsd can clear its latch.",
		entry.text);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_DEVICE, entry.kind);

	entry = (struct entry){0};
	own.event = OWS_ALARM_RETURNED;
	own.text[0] = '\0';
	message_alarm(&entry, &info, &own, &now);
	TEST_ASSERT_EQUAL_STRING("door device alarm is over: 1; at 2023-11-14T22:13:19; DS2406 "
	                         "12.000000000001; Entrance; Behind the shed",
	                         entry.text);
	TEST_ASSERT_EQUAL_UINT8(0, entry.kind);
}

static void test_an_alarm_of_a_device_that_does_not_work_says_why(void)
{
	struct ows_alarm fails = {.kind = OWS_ALARM_DEVICE,
	                          .event = OWS_ALARM_FAILED,
	                          .occurred_ns = 999 * NS_PER_S,
	                          .quality = OWS_Q_GOOD,
	                          .text = "cannot be armed: SetAlarm: no permission"};

	message_alarm(&entry, &info, &fails, &now);
	TEST_ASSERT_EQUAL_STRING_LEN("freezer device alarm does not work: cannot be armed: "
	                             "SetAlarm: no permission; since 2023-11-14T22:13:19; In the "
	                             "cellar; The device's own alarm",
	                             entry.text, 137);
	TEST_ASSERT_EQUAL_UINT8(0, entry.kind);
}

static void test_an_output_that_reads_otherwise_has_both_values(void)
{
	struct ows_alarm differs = {.kind = OWS_ALARM_DIFFERS,
	                            .event = OWS_ALARM_RAISED,
	                            .occurred_ns = 999 * NS_PER_S,
	                            .before_integer = 1,
	                            .has_before = 1,
	                            .has_after = 1,
	                            .type = OWS_BOOL,
	                            .quality = OWS_Q_DIFFERS};

	info.unit = info.description = "";
	message_alarm(&entry, &info, &differs, &now);
	TEST_ASSERT_EQUAL_STRING_LEN("freezer not as commanded: 0, written 1; since "
	                             "2023-11-14T22:13:19; The output reads otherwise than it was "
	                             "written. Did the device",
	                             entry.text, 126);
}

static void test_a_value_that_stays_bad_has_its_reason_and_a_remedy(void)
{
	message_bad(&entry, &info, 400 * NS_PER_S, "no answer", "Look there.", &now);
	TEST_ASSERT_EQUAL_STRING("freezer bad: no answer; for 10m; since 2023-11-14T22:03:20; In "
	                         "the cellar; Look there.",
	                         entry.text);
	TEST_ASSERT_EQUAL_UINT8(ENTRY_BAD, entry.kind);
}

static void test_when_it_is_told_its_time_is_that_of_the_clock_as_it_is_then(void)
{
	struct when set = now;

	message_alarm(&entry, &info, &low, &now);
	set.wall += 3600 * NS_PER_S;
	message_renew(&entry, &set);
	TEST_ASSERT_NOT_NULL(strstr(entry.text, "; since 2023-11-14T23:13:19; In the cellar"));
}

/* A character that would turn a line around is three bytes, and the "?" in its place is one. */
static void test_its_time_stands_in_its_place_behind_odd_characters_too(void)
{
	struct when set = now;

	set.wall += 3600 * NS_PER_S;
	message_bad(&entry, &info, 400 * NS_PER_S, "\xe2\x80\xae\xff\xe2\x80\xa8 no\n answer",
	            "Look there.", &now);
	message_renew(&entry, &set);
	TEST_ASSERT_EQUAL_STRING("freezer bad: ??? no? answer; for 10m; since 2023-11-14T23:03:20; "
	                         "In the cellar; Look there.",
	                         entry.text);
}

static void test_what_ended_before_it_is_told_says_so_once(void)
{
	message_alarm(&entry, &info, &low, &now);
	entry.ended = "returned";
	entry.ended_ns = 999 * NS_PER_S + 500;
	message_renew(&entry, &now);
	message_renew(&entry, &now);
	TEST_ASSERT_EQUAL_STRING("freezer low low: -40.3 °C; 10.3 °C below LimitLL -30 °C; since "
	                         "2023-11-14T22:13:19; In the cellar; returned at "
	                         "2023-11-14T22:13:19",
	                         entry.text);
}

static void test_the_longest_line_keeps_room_for_its_end(void)
{
	static char much[ENTRY_TEXT + 100];

	memset(much, 'x', sizeof(much) - 1);
	info.description = much;
	message_alarm(&entry, &info, &low, &now);
	entry.ended = "returned";
	entry.ended_ns = 999 * NS_PER_S;
	message_renew(&entry, &now);
	TEST_ASSERT_EQUAL_STRING("x; returned at 2023-11-14T22:13:19",
	                         strchr(entry.text, '\0') - 34);
}

static void test_an_escalation_says_for_how_long(void)
{
	message_escalated(&entry, &info, OWS_ALARM_H, 400 * NS_PER_S, "31", &now);
	TEST_ASSERT_TRUE(entry.escalated);
	TEST_ASSERT_EQUAL_STRING("freezer high: 31 °C; nobody has acknowledged this for 10m; since "
	                         "2023-11-14T22:03:20; In the cellar",
	                         entry.text);
}

static struct message one(void)
{
	return (struct message){.instance = "OWS",
	                        .host = "pi7",
	                        .list = {&entry},
	                        .count = 1,
	                        .link = "http://pi7/"};
}

static const char *mail_of(const struct message *message)
{
	FILE *out = open_memstream(&text, &len);

	message_mail(message, "a@b", "c@d", out);
	fclose(out);
	return text;
}

static void test_a_mail_is_whole(void)
{
	struct message message = one();

	entry.critical = true;
	message_line(&entry, "%s", "room high: 31; since noon");
	TEST_ASSERT_EQUAL_STRING("From: c@d\nTo: a@b\nSubject: room high: 31 [pi7 OWS]\n"
	                         "Auto-Submitted: auto-generated\nMIME-Version: 1.0\n"
	                         "Content-Type: text/plain; charset=utf-8\n"
	                         "Content-Transfer-Encoding: 8bit\n\n"
	                         "! room high: 31; since noon\n\nowsd OWS on pi7\nhttp://pi7/\n",
	                         mail_of(&message));
}

static void test_no_line_end_makes_a_header_or_a_second_line(void)
{
	static const char separator[] = "x\xe2\x80\xa8"
					"Bcc: eve@evil";
	const char *const evil[] = {"x\r\nBcc: eve@evil", "x\nBcc: eve@evil", "x\rBcc: eve@evil",
	                            separator, "x\v\fBcc: eve@evil\n\n.\n"};
	struct message message = one();

	for (size_t i = 0; i < sizeof(evil) / sizeof(evil[0]); i++) {
		message_line(&entry, "%s", evil[i]);
		message.instance = evil[i];
		TEST_ASSERT_NULL(strpbrk(entry.text, "\r\n\v\f"));
		mail_of(&message);
		/* the header alone, of which the body is no part */
		*strstr(text, "\n\n") = '\0';
		TEST_ASSERT_NULL(strstr(text, "\nBcc"));
		TEST_ASSERT_NULL(strpbrk(text, "\r\v\f"));
		TEST_ASSERT_NOT_NULL(strstr(text, "\nContent-Transfer-Encoding: 8bit"));
		free(text);
		text = NULL;
	}
}

static void test_a_title_beyond_ascii_is_encoded_in_short_words(void)
{
	struct message message = one();

	message_line(
		&entry, "%s",
		"k\xc3\xbchlhaus-mit-einem-langen-namen-der-nicht-endet-\xc3\xbc\xc3\xbc high: 3 "
		"\xc2\xb0"
		"C; x");
	mail_of(&message);
	TEST_ASSERT_NOT_NULL(strstr(text, "Subject: =?UTF-8?Q?k=C3=BChlhaus=2Dmit"));
	for (const char *line = strstr(text, "Subject: "); line[1] != '\n';
	     line = strchr(line, '\n') + 1) {
		TEST_ASSERT_LESS_THAN_size_t(85, strcspn(line, "\n"));
		if (!strncmp(line, "Auto", 4))
			break;
	}
	/* one that looks like a word of RFC 2047 is none */
	free(text);
	message_line(&entry, "=?UTF-8?Q?evil?=");
	TEST_ASSERT_NOT_NULL(
		strstr(mail_of(&message), "Subject: =?UTF-8?Q?=3D=3FUTF=2D8=3FQ=3Fevil"));
}

static void test_a_title_of_several_counts_all(void)
{
	struct message message = one();
	char title[MESSAGE_TITLE];

	message_line(&entry, "room high: 31; x");
	message.list[message.count++] = &entry;
	message.others = 7;
	TEST_ASSERT_EQUAL_STRING("9 messages; room high: 31 and others [pi7 OWS]",
	                         message_title(&message, title));
}

static void test_a_message_names_what_fits_and_counts_the_others(void)
{
	struct message message = {.instance = "OWS", .host = "pi7"};

	message_line(&entry, "%0400d", 0);
	for (int i = 0; i < 10; i++)
		message_add(&message, &entry);
	TEST_ASSERT_EQUAL_UINT(8, message.count);
	TEST_ASSERT_EQUAL_UINT64(2, message.others);
	TEST_ASSERT_NOT_NULL(strstr(mail_of(&message), "\n2 others: owsctl journal has them\n"));
}

static void test_a_line_is_no_option_of_a_program(void)
{
	message_line(&entry, "-rf high: 31; x");
	TEST_ASSERT_EQUAL_STRING("?rf high: 31; x", entry.text);
}

static void test_json_has_fields_and_escapes(void)
{
	struct message message = one();
	FILE *out = open_memstream(&text, &len);

	message.fields = " topic=a\"b  chat_id=12=3";
	message_line(&entry, "room \"x\"; y");
	message_json(&message, out);
	fclose(out);
	TEST_ASSERT_EQUAL_STRING_LEN("{\"topic\":\"a\\\"b\",\"chat_id\":\"12=3\",\"title\":\"room "
	                             "\\\"x\\\" [pi7 OWS]\",\"message\":\"room \\\"x\\\"; y\\n\\n",
	                             text, 90);
	TEST_ASSERT_NOT_NULL(strstr(text, "\"priority\":3,\"instance\":\"OWS\",\"host\":\"pi7\","
	                                  "\"click\":\"http://pi7/\",\"alarms\":[{\"text\":"));
}

static void test_a_token_takes_its_place_in_the_url(void)
{
	char url[32];

	TEST_ASSERT_TRUE(message_url("https://t/bot{token}/send", "1:a", url, sizeof(url)));
	TEST_ASSERT_EQUAL_STRING("https://t/bot1:a/send", url);
	TEST_ASSERT_FALSE(message_url("https://t/send", "1:a", url, sizeof(url)));
	TEST_ASSERT_FALSE(
		message_url("https://t/bot{token}/send", "1234567890123456", url, sizeof(url)));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_alarm_has_value_limit_time_and_what_it_is);
	RUN_TEST(test_an_alarm_that_is_bad_has_no_number);
	RUN_TEST(test_one_that_is_back_says_so);
	RUN_TEST(test_an_alarm_of_a_device_says_where_it_is_what_it_means_and_what_to_do);
	RUN_TEST(test_an_alarm_of_a_device_that_does_not_work_says_why);
	RUN_TEST(test_an_output_that_reads_otherwise_has_both_values);
	RUN_TEST(test_a_value_that_stays_bad_has_its_reason_and_a_remedy);
	RUN_TEST(test_when_it_is_told_its_time_is_that_of_the_clock_as_it_is_then);
	RUN_TEST(test_its_time_stands_in_its_place_behind_odd_characters_too);
	RUN_TEST(test_what_ended_before_it_is_told_says_so_once);
	RUN_TEST(test_the_longest_line_keeps_room_for_its_end);
	RUN_TEST(test_an_escalation_says_for_how_long);
	RUN_TEST(test_a_mail_is_whole);
	RUN_TEST(test_no_line_end_makes_a_header_or_a_second_line);
	RUN_TEST(test_a_title_beyond_ascii_is_encoded_in_short_words);
	RUN_TEST(test_a_title_of_several_counts_all);
	RUN_TEST(test_a_message_names_what_fits_and_counts_the_others);
	RUN_TEST(test_a_line_is_no_option_of_a_program);
	RUN_TEST(test_json_has_fields_and_escapes);
	RUN_TEST(test_a_token_takes_its_place_in_the_url);
	return UNITY_END();
}
