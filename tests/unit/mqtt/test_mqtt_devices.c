/* SPDX-License-Identifier: MIT */
/* Tests of the list of devices: what owsd answers, and what becomes of it. */
#include <string.h>

#include "unity.h"

#include "hal/owfs/frame.h"
#include "src/faces/mqtt/devices.h"
#include "tests/unit/aid/published.h"

static char answer[512];
static size_t answer_len;

void setUp(void)
{
	answer_len = 0;
}

void tearDown(void)
{
}

static void add_frame(int32_t payload, int32_t type, const char *data)
{
	struct frame_header header = {.payload = payload, .type = type};

	frame_put_header((uint8_t *)answer + answer_len, &header);
	answer_len += FRAME_HEADER;
	if (*data)
		memcpy(answer + answer_len, data, (size_t)payload);
	answer_len += payload > 0 ? (size_t)payload : 0;
	answer[answer_len] = '\0';
}

static void test_the_request_is_one_for_the_root(void)
{
	uint8_t request[DEVICES_REQUEST];
	struct frame_header header;

	TEST_ASSERT_EQUAL_INT(FRAME_HEADER + 2, devices_request(request));
	frame_get_header(request, &header);
	TEST_ASSERT_EQUAL_INT32(FRAME_DIRALL, header.type);
	TEST_ASSERT_EQUAL_STRING("/", (char *)request + FRAME_HEADER);
}

static void test_the_list_is_behind_all_that_says_that_owsd_lives(void)
{
	add_frame(-1, 0, "");
	add_frame(-1, 0, "");
	add_frame(4, 0, "/a,/");
	TEST_ASSERT_EQUAL_STRING("/a,/", devices_listing(answer, answer_len));
}

static void test_what_is_cut_or_an_error_is_no_list(void)
{
	TEST_ASSERT_NULL(devices_listing(answer, 0));
	add_frame(0, -5, "");
	TEST_ASSERT_NULL(devices_listing(answer, answer_len));
	answer_len = 0;
	add_frame(4, 0, "/a,/");
	for (size_t len = 0; len < answer_len; len++)
		TEST_ASSERT_NULL(devices_listing(answer, len));
	answer_len = 0;
	add_frame(-2, 0, "");
	TEST_ASSERT_NULL(devices_listing(answer, answer_len));
	answer_len = 0;
	add_frame(0, 0, "");
	TEST_ASSERT_EQUAL_STRING("", devices_listing(answer, answer_len));
}

static const char *json_of(struct published *p, char *listing)
{
	struct json json;

	stream_message(&p->s, &json);
	json_object(&json, NULL);
	devices_json(&json, &p->s, listing);
	json_object_end(&json);
	fflush(p->s.out);
	p->s.text[p->s.len] = '\0';
	return p->s.text;
}

static void test_what_was_found_has_its_id_and_no_signal(void)
{
	static const struct instance_signal signals[] = {
		{.name = "load", .path = "/statistics/load", .type = OWS_DOUBLE}};
	char listing[] = "/26.67C6697351FF,/bus.0,/alias,/28.67C6697351FF/temperature,/uncached";
	static struct published p;
	const char *text;

	published_start(&p, signals, 1, profiles_find("plain"));
	TEST_ASSERT_EQUAL_STRING("{\"devices\":[]}", json_of(&p, NULL));
	text = json_of(&p, listing);
	TEST_ASSERT_NOT_NULL_MESSAGE(
		strstr(text, "{\"devices\":[{\"id\":\"26.67C6697351FF\",\"family\":\"26\","), text);
	TEST_ASSERT_NOT_NULL_MESSAGE(
		strstr(text, ",\"signals\":[],\"path\":\"/26.67C6697351FF\"}]}"), text);
	published_end(&p);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_request_is_one_for_the_root);
	RUN_TEST(test_the_list_is_behind_all_that_says_that_owsd_lives);
	RUN_TEST(test_what_is_cut_or_an_error_is_no_list);
	RUN_TEST(test_what_was_found_has_its_id_and_no_signal);
	return UNITY_END();
}
