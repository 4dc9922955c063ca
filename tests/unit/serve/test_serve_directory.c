/* SPDX-License-Identifier: MIT */
/* Tests of directories of the served protocol. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

#include "hal/owfs/frame.h"
#include "src/daemon/serve/directory.h"

static struct directory *directory;
static struct buses buses;
static struct node node;
static struct directory_form form;

void setUp(void)
{
	directory = calloc(1, sizeof(*directory));
	TEST_ASSERT_NOT_NULL(directory);
	buses = (struct buses){0};
	directory_begin(directory);
}

void tearDown(void)
{
	free(directory);
}

static void begin(const char *path, uint32_t flags)
{
	node_parse(path, strlen(path), &node);
	form = (struct directory_form){
		.node = &node, .prefix = path, .prefix_len = strlen(path), .flags = flags};
	if (strcmp(path, "/") == 0)
		form.prefix_len = 0;
}

static void take(unsigned target, const char *paths)
{
	uint32_t room;

	memcpy(directory_room(directory, &room), paths, strlen(paths));
	TEST_ASSERT_GREATER_THAN_UINT32(strlen(paths), room);
	directory_take(directory, &node, &buses, target, (uint32_t)strlen(paths));
}

static const char *formed(struct frame_header *h)
{
	TEST_ASSERT_EQUAL_INT(0, directory_form(directory, &form));
	frame_get_header(directory->out, h);
	TEST_ASSERT_EQUAL_UINT32(directory->out_len, (uint32_t)h->payload + FRAME_HEADER);
	return (const char *)directory->out + FRAME_HEADER;
}

static void test_devices_of_two_targets_are_listed_once(void)
{
	struct frame_header h;

	begin("/", 0);
	take(0, "/28.551DDF030000\n/29.B89115000000\n/bus.0\n/settings\n/alarm\n");
	take(1, "/29.B89115000000\n/26.551DDF030000\n/bus.0\n/bus.1\n/settings\n");
	TEST_ASSERT_EQUAL_STRING("/28.551DDF030000,/29.B89115000000,/26.551DDF030000", formed(&h));
	TEST_ASSERT_EQUAL_INT(h.payload - 1, h.size);
	TEST_ASSERT_EQUAL_HEX32(0xc007, h.offset);
	TEST_ASSERT_EQUAL_UINT(3, buses.count);
	TEST_ASSERT_EQUAL_UINT(1, buses.bus[2].target);
	TEST_ASSERT_EQUAL_UINT(1, buses.bus[2].number);
}

static void test_buses_keep_their_numbers(void)
{
	TEST_ASSERT_EQUAL_INT(0, buses_number(&buses, 1, 0));
	TEST_ASSERT_EQUAL_INT(1, buses_number(&buses, 0, 0));
	TEST_ASSERT_EQUAL_INT(0, buses_number(&buses, 1, 0));
	for (unsigned i = 2; i < BUSES_MAX; i++)
		TEST_ASSERT_EQUAL_INT(i, buses_number(&buses, 0, i));
	TEST_ASSERT_EQUAL_INT(-1, buses_number(&buses, 2, 0));
	/* the second target goes, and its number with it: there is room for another */
	buses_renumber(&buses, (const int[]){0}, 1);
	TEST_ASSERT_EQUAL_INT(1, buses_number(&buses, 0, 0));
	TEST_ASSERT_EQUAL_INT(0, buses_number(&buses, 2, 0));
	TEST_ASSERT_EQUAL_INT(0, buses_number(&buses, 2, 0));
	TEST_ASSERT_EQUAL_INT(-1, buses_number(&buses, 2, 1));
	TEST_ASSERT_EQUAL_INT(12, buses_parse("bus.12", 6));
	TEST_ASSERT_EQUAL_INT(-1, buses_parse("bus.1x", 6));
	TEST_ASSERT_EQUAL_INT(-1, buses_parse("bus.", 4));
}

static void test_the_root_lists_no_bus_of_a_target_that_a_reload_removed(void)
{
	struct frame_header h;

	for (unsigned target = 0; target < 3; target++)
		TEST_ASSERT_EQUAL_INT(target, buses_number(&buses, target, 0));
	buses_renumber(&buses, (const int[]){0, 2}, 2);
	begin("/", 0);
	directory_add_rest(directory, &node, &buses);
	TEST_ASSERT_EQUAL_STRING_LEN("/bus.0,/bus.2,/uncached", formed(&h), 23);
}

static void test_names_are_in_the_format_and_below_the_path_that_the_client_wrote(void)
{
	struct frame_header h;

	begin("/uncached/bus.3", 0x2000000);
	form.slash = true;
	take(0, "/bus.0/interface\n/bus.0/28.551DDF030000\n");
	TEST_ASSERT_EQUAL_STRING("/uncached/bus.3/interface/,/uncached/bus.3/28.551DDF030000.34/",
	                         formed(&h));
}

static void test_frames_come_one_by_one_and_then_an_empty_one(void)
{
	const uint8_t *at;
	struct frame_header h;

	begin("/28.551DDF030000", 0x104);
	form.frames = true;
	take(0, "/28.551DDF030000/id\n/28.551DDF030000/type\n");
	TEST_ASSERT_EQUAL_INT(0, directory_form(directory, &form));
	at = directory->out;
	for (int i = 0; i < 2; i++) {
		frame_get_header(at, &h);
		TEST_ASSERT_EQUAL_INT(h.size + 1, h.payload);
		TEST_ASSERT_EQUAL_STRING(i ? "/28.551DDF030000/type" : "/28.551DDF030000/id",
		                         at + FRAME_HEADER);
		at += FRAME_HEADER + h.payload;
	}
	frame_get_header(at, &h);
	TEST_ASSERT_EQUAL_INT(0, h.payload);
	TEST_ASSERT_EQUAL_HEX32(0x104, h.flags);
	TEST_ASSERT_EQUAL_PTR(directory->out + directory->out_len, at + FRAME_HEADER);
}

static void test_an_empty_directory_has_no_data(void)
{
	struct frame_header h;

	begin("/alarm", 0);
	take(0, "");
	formed(&h);
	TEST_ASSERT_EQUAL_INT(0, h.payload);
	TEST_ASSERT_EQUAL_INT(0, h.size);
}

static void test_the_flags_of_a_list_of_alarms_are_none(void)
{
	static const char *const paths[] = {"/alarm", "/bus.0/alarm", "/uncached/alarm"};
	struct frame_header h;

	for (size_t i = 0; i < sizeof(paths) / sizeof(paths[0]); i++) {
		directory_begin(directory);
		begin(paths[i], 0);
		take(0, "/alarm/29.B89115000000\n");
		formed(&h);
		TEST_ASSERT_GREATER_THAN_INT(0, h.payload);
		TEST_ASSERT_EQUAL_HEX32(0, h.offset);
	}
}

static void test_lines_that_are_cut_are_left_out(void)
{
	struct frame_header h;

	begin("/", 0);
	take(0, "/28.551DDF030000\n\n/29.B891");
	TEST_ASSERT_EQUAL_STRING("/28.551DDF030000", formed(&h));
}

static void test_what_does_not_fit_is_an_error(void)
{
	char name[64];

	begin("/signals", 0);
	memset(name, 'x', sizeof(name));
	while (directory_add(directory, name, 20))
		;
	form.frames = true;
	form.prefix = node.path;
	TEST_ASSERT_EQUAL_INT(0, directory_form(directory, &form));
	directory_begin(directory);
	while (directory_add(directory, name, 1))
		;
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, directory_form(directory, &form));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_devices_of_two_targets_are_listed_once);
	RUN_TEST(test_buses_keep_their_numbers);
	RUN_TEST(test_the_root_lists_no_bus_of_a_target_that_a_reload_removed);
	RUN_TEST(test_names_are_in_the_format_and_below_the_path_that_the_client_wrote);
	RUN_TEST(test_frames_come_one_by_one_and_then_an_empty_one);
	RUN_TEST(test_an_empty_directory_has_no_data);
	RUN_TEST(test_the_flags_of_a_list_of_alarms_are_none);
	RUN_TEST(test_lines_that_are_cut_are_left_out);
	RUN_TEST(test_what_does_not_fit_is_an_error);
	return UNITY_END();
}
