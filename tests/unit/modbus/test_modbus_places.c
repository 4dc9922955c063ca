/* SPDX-License-Identifier: MIT */
/* Tests of the places of signals over a map that cannot be read or written for a while. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/modbus/modbus.h"
#include "tests/unit/aid/instance.h"

#define S INSTANCE_S

static const struct instance_signal signals[] = {
	{.name = "room", .path = "/28.1/t", .identity = "/28.1/t", .type = OWS_DOUBLE},
	{.name = "hall", .path = "/28.2/t", .identity = "/28.2/t", .type = OWS_DOUBLE},
	{.name = "room", .path = "/28.1/t", .identity = "/28.1/t", .type = OWS_DOUBLE},
};

static struct instance in;
static struct config config;
static struct face_arguments arguments;
static const struct face_ops ops = {.program = "owsd-modbus"};
static struct face face;
static char folder[] = "/tmp/owsd-places-XXXXXX", path[64], fresh[72];

void setUp(void)
{
	memcpy(folder + sizeof(folder) - 7, "XXXXXX", 6);
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/map", folder);
	snprintf(fresh, sizeof(fresh), "%s.new", path);
	setenv("STATE_DIRECTORY", folder, 1);
	instance_start(&in, "places", signals, 2);
	config = (struct config){
		.modbus = {.given = true, .word_order = "big", .bad_value = "nan"}};
	arguments.instance = in.name;
	face = (struct face){.ops = &ops, .arguments = &arguments, .config = &config};
	face.log = log_create(LOG_LEVEL_ERR);
}

void tearDown(void)
{
	char lock[64];

	modbus_close(&face);
	ows_close(face.ows);
	log_destroy(face.log);
	instance_end(&in);
	snprintf(lock, sizeof(lock), "%s/lock", folder);
	unlink(lock);
	unlink(path);
	TEST_ASSERT_EQUAL_INT(0, rmdir(folder));
}

static void find_owsd(void)
{
	TEST_ASSERT_EQUAL_INT(0, modbus_open(&face));
	TEST_ASSERT_EQUAL_INT(0, ows_open(in.name, OWS_READ, &face.ows));
	face.live = true;
	modbus_event(&face, &(struct face_event){.news = FACE_FOUND});
}

/* The face has its turn when it wants it, and that is soon. */
static void some_time_later(void)
{
	int64_t now_ns = ows_now();

	TEST_ASSERT_LESS_OR_EQUAL(now_ns + 10 * S, face.tick_ns);
	modbus_tick(&face, now_ns + 10 * S);
}

static const char *trouble(void)
{
	static char text[1000];
	FILE *out = fmemopen(text, sizeof(text), "w");
	char *found;

	modbus_report(&face, out);
	fclose(out);
	found = strstr(text, "trouble ");
	return found ? found : "";
}

static void test_a_map_that_can_be_read_again_is(void)
{
	struct modbus *m;
	FILE *out;

	TEST_ASSERT_EQUAL_INT(0, mkdir(path, 0700));
	find_owsd();
	m = face.own;
	some_time_later();
	TEST_ASSERT_EQUAL_STRING("trouble the map of addresses cannot be read\n", trouble());
	TEST_ASSERT_EQUAL_UINT(0, m->signals);
	rmdir(path);
	out = fopen(path, "w");
	TEST_ASSERT_TRUE(out && fputs("7 /28.2/t\n", out) > 0 && fclose(out) == 0);
	some_time_later();
	TEST_ASSERT_EQUAL_STRING("", trouble());
	TEST_ASSERT_EQUAL_UINT(2, m->signals);
	TEST_ASSERT_EQUAL_UINT(7, map_known(&m->map, "/28.2/t"));
	TEST_ASSERT_EQUAL_UINT(8, map_known(&m->map, "/28.1/t"));
}

static void test_a_map_that_can_be_written_again_is(void)
{
	static struct map kept;
	unsigned line;

	TEST_ASSERT_EQUAL_INT(0, mkdir(fresh, 0700));
	find_owsd();
	some_time_later();
	TEST_ASSERT_EQUAL_STRING("trouble the map of addresses cannot be written\n", trouble());
	TEST_ASSERT_NOT_EQUAL_INT(0, access(path, F_OK));
	rmdir(fresh);
	some_time_later();
	TEST_ASSERT_EQUAL_STRING("", trouble());
	TEST_ASSERT_EQUAL_INT(0, map_read(&kept, path, &line));
	TEST_ASSERT_EQUAL_UINT(2, map_known(&kept, "/28.2/t"));
	map_free(&kept);
}

static void test_a_place_that_was_not_written_yet_stays_over_a_reload(void)
{
	struct modbus *m;

	TEST_ASSERT_EQUAL_INT(0, mkdir(fresh, 0700));
	find_owsd();
	m = face.own;
	instance_reload(&in, signals + 1, 2); /* in another order */
	TEST_ASSERT_EQUAL_INT(0, ows_reopen(face.ows));
	modbus_event(&face, &(struct face_event){.news = FACE_RELOADED});
	TEST_ASSERT_EQUAL_UINT(1, map_known(&m->map, "/28.1/t"));
	TEST_ASSERT_EQUAL_UINT(2, map_known(&m->map, "/28.2/t"));
	TEST_ASSERT_EQUAL_INT(0, m->map.places[2].signal);
	rmdir(fresh);
	some_time_later();
	TEST_ASSERT_EQUAL_STRING("", trouble());
}

static void test_a_directory_that_comes_late_with_its_map_gives_the_places(void)
{
	char late[64], map[72];
	FILE *out;
	struct modbus *m;

	snprintf(late, sizeof(late), "%s/late", folder);
	setenv("STATE_DIRECTORY", late, 1);
	out = fopen(late, "w");
	TEST_ASSERT_TRUE(out && fclose(out) == 0);
	find_owsd();
	m = face.own;
	some_time_later();
	TEST_ASSERT_NOT_EQUAL_INT(0, *trouble());
	unlink(late);
	TEST_ASSERT_EQUAL_INT(0, mkdir(late, 0700));
	snprintf(map, sizeof(map), "%s/map", late);
	out = fopen(map, "w");
	TEST_ASSERT_TRUE(out && fputs("7 /28.1/t\n", out) > 0 && fclose(out) == 0);
	some_time_later();
	TEST_ASSERT_EQUAL_STRING("", trouble());
	TEST_ASSERT_EQUAL_UINT(7, map_known(&m->map, "/28.1/t"));
	TEST_ASSERT_EQUAL_INT(-EBUSY, history_lock(late));
	unlink(map);
	snprintf(map, sizeof(map), "%s/lock", late);
	unlink(map);
	rmdir(late);
}

/* It has the addresses: nobody else gives others, until it has ended. */
static void test_a_late_directory_of_another_program_is_left_to_it(void)
{
	char late[64], file[72];
	struct modbus *m;
	FILE *out;
	int lock;

	snprintf(late, sizeof(late), "%s/late", folder);
	setenv("STATE_DIRECTORY", late, 1);
	out = fopen(late, "w");
	TEST_ASSERT_TRUE(out && fclose(out) == 0);
	find_owsd();
	m = face.own;
	unlink(late);
	TEST_ASSERT_EQUAL_INT(0, mkdir(late, 0700));
	lock = history_lock(late);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, lock);
	some_time_later();
	snprintf(file, sizeof(file), "%s/map", late);
	TEST_ASSERT_NOT_EQUAL_INT(0, access(file, F_OK));
	TEST_ASSERT_EQUAL_UINT(0, m->signals);
	close(lock);
	some_time_later();
	TEST_ASSERT_EQUAL_INT(0, unlink(file));
	TEST_ASSERT_EQUAL_UINT(2, m->signals);
	snprintf(file, sizeof(file), "%s/lock", late);
	unlink(file);
	rmdir(late);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_map_that_can_be_read_again_is);
	RUN_TEST(test_a_map_that_can_be_written_again_is);
	RUN_TEST(test_a_place_that_was_not_written_yet_stays_over_a_reload);
	RUN_TEST(test_a_directory_that_comes_late_with_its_map_gives_the_places);
	RUN_TEST(test_a_late_directory_of_another_program_is_left_to_it);
	return UNITY_END();
}
