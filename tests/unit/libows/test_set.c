/* SPDX-License-Identifier: MIT */
/* Tests of setting outputs and attributes by libows. */
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/memory/libows/handle.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"heat", "/3A.1/PIO.A", OWS_BOOL, true, 0},
	{"valve", "/3A.1/PIO.B", OWS_DOUBLE, true, 0},
	{"text", "/23.1/memory", OWS_STRING, true, 0},
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"small", "/20.1/x", OWS_BYTE, true, 0},
};
#define COUNT 5
enum { HEAT = 1, VALVE, TEXT, ROOM, SMALL };

static struct instance in;
static struct ows *h;

void setUp(void)
{
	instance_start(&in, "set", signals, COUNT);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

static struct controller_command load(uint32_t slot)
{
	return instance_command(&in, 0, slot);
}

static struct ows_command_slot *slot_at(uint32_t record)
{
	return instance_slot(&in, 0, record);
}

static struct ows_controller_header *header(void)
{
	return (struct ows_controller_header *)(void *)instance_controller(&in, 0)->base;
}

static int next_dirty(void)
{
	return controller_next_dirty(instance_controller(&in, 0), 0);
}

static void test_a_set_reaches_the_engine_with_stamp_mark_and_bell(void)
{
	uint32_t stamp;

	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "valve"), 0.25, &stamp));
	TEST_ASSERT_EQUAL(1, stamp);
	TEST_ASSERT_EQUAL_INT64(value_of_double(0.25), load(VALVE).value);
	TEST_ASSERT_EQUAL(1, load(VALVE).stamp);
	TEST_ASSERT_TRUE(controller_marked(instance_controller(&in, 0)));
	TEST_ASSERT_EQUAL(VALVE, next_dirty());
	TEST_ASSERT_EQUAL(-1, next_dirty());
	TEST_ASSERT_EQUAL(1, door_rings(in.door, 0));
}

static void test_an_engine_that_is_awake_needs_no_bell(void)
{
	image_awake(&in.image, true);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "valve"), 0.25, NULL));
	TEST_ASSERT_TRUE(controller_marked(instance_controller(&in, 0)));
	TEST_ASSERT_EQUAL(0, door_rings(in.door, 0));
	image_awake(&in.image, false);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "valve"), 0.5, NULL));
	TEST_ASSERT_EQUAL(1, door_rings(in.door, 0));
}

static void test_each_set_of_a_handle_has_a_greater_stamp(void)
{
	uint32_t first, second, third;

	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "valve"), 1, &first));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat"), 1, &second));
	TEST_ASSERT_EQUAL(0, ows_set_text(h, ows_find(h, "text"), "x", &third));
	TEST_ASSERT_EQUAL(1, first);
	TEST_ASSERT_EQUAL(2, second);
	TEST_ASSERT_EQUAL(3, third);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat_RE"), 1, &third));
	TEST_ASSERT_EQUAL(0, third);
}

static void test_what_owsd_took_and_confirmed_is_this_handles_own(void)
{
	int valve = ows_find(h, "valve");
	struct ows_command command;
	struct ows_value v;
	struct ows *other;
	uint32_t stamp;

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &other));
	TEST_ASSERT_EQUAL(0, ows_set(h, valve, 1, &stamp));
	TEST_ASSERT_EQUAL(0, ows_command(h, valve, &command));
	TEST_ASSERT_EQUAL(0, command.taken);
	controller_taken(instance_controller(&in, 0), VALVE, stamp, 0);
	controller_applied(instance_controller(&in, 0), VALVE, stamp);
	TEST_ASSERT_EQUAL(0, ows_command(h, valve, &command));
	TEST_ASSERT_EQUAL(stamp, command.taken);
	TEST_ASSERT_EQUAL(stamp, command.applied);
	TEST_ASSERT_EQUAL(0, command.refused);
	TEST_ASSERT_EQUAL(0, ows_get(h, valve, ows_now(), &v));
	TEST_ASSERT_EQUAL(stamp, v.applied);
	TEST_ASSERT_EQUAL(0, ows_get(other, ows_find(other, "valve"), ows_now(), &v));
	TEST_ASSERT_EQUAL(0, v.applied);
	TEST_ASSERT_EQUAL(0, ows_set(h, valve, 2, &stamp));
	controller_taken(instance_controller(&in, 0), VALVE, stamp, -ERANGE);
	TEST_ASSERT_EQUAL(0, ows_command(h, valve, &command));
	TEST_ASSERT_EQUAL(-ERANGE, command.refused);
	ows_close(other);
}

static bool reached(int id, uint32_t stamp)
{
	struct ows_command command;
	struct ows_value v;

	TEST_ASSERT_EQUAL(0, ows_get(h, id, ows_now(), &v));
	TEST_ASSERT_EQUAL(0, ows_command(h, id, &command));
	TEST_ASSERT_EQUAL_HEX32(v.applied, command.applied);
	return (int32_t)(v.applied - stamp) >= 0;
}

/* A program that sets all else in each cycle gets that far between two sets of the valve. */
static void test_what_was_confirmed_2_to_the_31_sets_ago_confirms_no_new_set(void)
{
	static const uint32_t confirmed[] = {0, 5, 0x7fffffff, 0x80000001};
	int valve = ows_find(h, "valve");
	uint32_t first, second;

	for (unsigned i = 0; i < sizeof(confirmed) / sizeof(confirmed[0]); i++) {
		controller_applied(instance_controller(&in, 0), VALVE, confirmed[i]);
		h->stamp = confirmed[i] + 0x80000010u;
		TEST_ASSERT_EQUAL(0, ows_set(h, valve, 1, &first));
		TEST_ASSERT_FALSE(reached(valve, first));
		TEST_ASSERT_EQUAL(0, ows_set(h, valve, 0, &second));
		TEST_ASSERT_FALSE(reached(valve, first));
		TEST_ASSERT_FALSE(reached(valve, second));
		controller_applied(instance_controller(&in, 0), VALVE, first);
		TEST_ASSERT_TRUE(reached(valve, first));
		TEST_ASSERT_FALSE(reached(valve, second));
		controller_applied(instance_controller(&in, 0), VALVE, second);
		TEST_ASSERT_TRUE(reached(valve, second));
	}
}

/* After a start the slot has what was confirmed before, and no stamp yet. */
static void test_what_was_confirmed_before_a_start_stays_so(void)
{
	controller_applied(instance_controller(&in, 0), VALVE, 7);
	TEST_ASSERT_TRUE(reached(ows_find(h, "valve"), 7));
	TEST_ASSERT_FALSE(reached(ows_find(h, "valve"), 8));
}

static void test_a_value_the_type_cannot_hold_is_refused(void)
{
	TEST_ASSERT_EQUAL(-ERANGE, ows_set(h, ows_find(h, "small"), 256, NULL));
	TEST_ASSERT_EQUAL(-ERANGE, ows_set_integer(h, ows_find(h, "small"), -1, NULL));
	TEST_ASSERT_EQUAL(-EINVAL, ows_set(h, ows_find(h, "valve"), (double)NAN, NULL));
	TEST_ASSERT_EQUAL(-EINVAL, ows_set(h, ows_find(h, "valve"), (double)INFINITY, NULL));
	TEST_ASSERT_EQUAL(0, load(SMALL).stamp);
	TEST_ASSERT_EQUAL(0, load(VALVE).stamp);
	TEST_ASSERT_EQUAL(-1, next_dirty());
}

static void test_an_input_takes_no_sets(void)
{
	TEST_ASSERT_EQUAL(-EACCES, ows_set(h, ows_find(h, "room1"), 1, NULL));
	TEST_ASSERT_EQUAL(-EACCES, ows_set(h, ows_find(h, "room1_Age"), 1, NULL));
	TEST_ASSERT_EQUAL(-EACCES, ows_set(h, ows_find(h, "_RECONNECTS"), 1, NULL));
	TEST_ASSERT_EQUAL(0, load(ROOM).stamp);
}

static void test_an_input_takes_sets_while_its_write_enable_is_on(void)
{
	struct ows_sample sample = {.quality = OWS_Q_GOOD};
	struct ows_attrs attrs = {.flags = OWS_ATTR_WRITE_ENABLE};

	image_publish(&in.image, ROOM, &sample, &attrs, NULL);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "room1"), 1, NULL));
	attrs.flags = 0;
	image_publish(&in.image, ROOM, &sample, &attrs, NULL);
	TEST_ASSERT_EQUAL(-EACCES, ows_set(h, ows_find(h, "room1"), 1, NULL));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "room1_WE"), 1, NULL));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "room1"), 1, NULL));
}

static void test_nothing_of_writing_is_set_of_an_input_whose_writable_is_off(void)
{
	static const char *const names[] = {"room1", "room1_WE", "room1_WriteEnable", "room1_WOS"};
	struct ows_attrs attrs = {.flags = OWS_ATTR_WRITE_ENABLE};
	struct ows_sample sample = {.quality = OWS_Q_GOOD};

	image_publish(&in.image, ROOM, &sample, &attrs, NULL);
	((struct ows_record *)&in.image.records[ROOM])->flags |= OWS_RECORD_NO_SET;
	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		TEST_ASSERT_EQUAL_MESSAGE(-EROFS, ows_set(h, ows_find(h, names[i]), 1, NULL),
		                          names[i]);
		TEST_ASSERT_EQUAL_MESSAGE(
			-EROFS, ows_set_integer(h, ows_find(h, names[i]), 0, NULL), names[i]);
		TEST_ASSERT_EQUAL_MESSAGE(-EROFS, ows_set_text(h, ows_find(h, names[i]), "1", NULL),
		                          names[i]);
	}
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "room1_RE"), 1, NULL));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "room1_DGNRESET"), 1, NULL));
}

static void test_a_reader_may_not_set(void)
{
	struct ows *reader;

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &reader));
	TEST_ASSERT_EQUAL(-EACCES, ows_set(reader, ows_find(reader, "heat"), 1, NULL));
	TEST_ASSERT_EQUAL(-EACCES, ows_beat(reader, 1000));
	TEST_ASSERT_EQUAL(-EACCES, ows_for(reader, "anna"));
	ows_close(reader);
}

static void test_enables_are_commanded_by_name(void)
{
	struct controller_command c;

	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat_RE"), 1, NULL));
	TEST_ASSERT_EQUAL(0, ows_set_integer(h, ows_find(h, "heat_WriteEnable"), 0, NULL));
	c = load(HEAT);
	TEST_ASSERT_EQUAL(2, c.read_enable);
	TEST_ASSERT_EQUAL(1, c.write_enable);
	TEST_ASSERT_EQUAL(0, c.stamp);
	TEST_ASSERT_EQUAL(HEAT, next_dirty());
	/* The same once more is new all the same: another program may have set it meanwhile */
	TEST_ASSERT_EQUAL(0, load(HEAT).read_enable);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat_RE"), 1, NULL));
	TEST_ASSERT_EQUAL(2, load(HEAT).read_enable);
}

static void test_a_flag_acts_when_it_goes_from_off_to_on(void)
{
	int shot = ows_find(h, "heat_WOS"), reset = ows_find(h, "_DGNRESET");

	for (int i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL(0, ows_set(h, shot, 1, NULL));
	TEST_ASSERT_EQUAL(1, slot_at(HEAT)->one_shot);
	TEST_ASSERT_EQUAL(0, ows_set(h, shot, 0, NULL));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat_WriteOneShot"), 1, NULL));
	TEST_ASSERT_EQUAL(2, slot_at(HEAT)->one_shot);
	TEST_ASSERT_EQUAL(0, ows_set(h, reset, 1, NULL));
	TEST_ASSERT_EQUAL(0, ows_set(h, reset, 1, NULL));
	TEST_ASSERT_EQUAL(1, slot_at(0)->dgn_reset);
	TEST_ASSERT_EQUAL(0, slot_at(HEAT)->dgn_reset);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat_DGNRESET"), 1, NULL));
	TEST_ASSERT_EQUAL(1, slot_at(HEAT)->dgn_reset);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat_ROS"), 1, NULL));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat_ReadOneShot"), 1, NULL));
	TEST_ASSERT_EQUAL(1 + OWS_STEP_READ, slot_at(HEAT)->dgn_reset);
	/* of a signal of which nothing else was set */
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "room1_ROS"), 1, NULL));
	TEST_ASSERT_EQUAL(OWS_STEP_READ, slot_at(ROOM)->dgn_reset);
}

static void test_of_many_values_all_are_set_with_one_ring_or_none(void)
{
	int ids[3] = {ows_find(h, "heat"), ows_find(h, "valve"), ows_find(h, "small")};
	double values[3] = {1, 2.5, 300};

	TEST_ASSERT_EQUAL(-ERANGE, ows_set_many(h, ids, values, 3));
	ids[2] = ows_find(h, "room1");
	TEST_ASSERT_LESS_THAN(0, ows_set_many(h, ids, values, 3));
	TEST_ASSERT_EQUAL(-1, next_dirty());
	TEST_ASSERT_EQUAL(0, door_rings(in.door, 0));
	TEST_ASSERT_EQUAL(0, ows_set_many(h, ids, values, 2));
	TEST_ASSERT_EQUAL(1, door_rings(in.door, 0));
	TEST_ASSERT_EQUAL(0, ows_set_many(h, ids, values, 0));
}

static void test_a_text_arrives_with_its_check_word(void)
{
	char text[INSTANCE_TEXT + 1];
	char longest[INSTANCE_TEXT + 2];
	int id = ows_find(h, "text");

	TEST_ASSERT_EQUAL(0, ows_set_text(h, id, "on the hill", NULL));
	TEST_ASSERT_EQUAL(11, controller_text(instance_controller(&in, 0), TEXT, text));
	TEST_ASSERT_EQUAL_STRING("on the hill", text);
	memset(longest, 'x', sizeof(longest));
	longest[INSTANCE_TEXT + 1] = '\0';
	TEST_ASSERT_EQUAL(-ERANGE, ows_set_text(h, id, longest, NULL));
	longest[INSTANCE_TEXT] = '\0';
	TEST_ASSERT_EQUAL(0, ows_set_text(h, id, longest, NULL));
	TEST_ASSERT_EQUAL(INSTANCE_TEXT, controller_text(instance_controller(&in, 0), TEXT, text));
	TEST_ASSERT_EQUAL(0, ows_set_text(h, id, "", NULL));
	TEST_ASSERT_EQUAL(0, controller_text(instance_controller(&in, 0), TEXT, text));
}

static void test_text_sets_a_number_too(void)
{
	TEST_ASSERT_EQUAL(0, ows_set_text(h, ows_find(h, "heat"), "on", NULL));
	TEST_ASSERT_EQUAL_INT64(1, load(HEAT).value);
	TEST_ASSERT_NOT_EQUAL(0, ows_set_text(h, ows_find(h, "valve"), "warm", NULL));
	TEST_ASSERT_NOT_EQUAL(0, ows_set(h, ows_find(h, "text"), 1, NULL));
}

static void test_a_beat_and_its_promise_reach_the_engine(void)
{
	struct controller_beat beat;

	TEST_ASSERT_EQUAL(-EINVAL, ows_beat(h, 0));
	TEST_ASSERT_EQUAL(-ERANGE, ows_beat(h, OWS_BEAT_MOST_MS + 1));
	TEST_ASSERT_EQUAL(0, ows_beat(h, OWS_BEAT_MOST_MS));
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL(OWS_BEAT_MOST_MS, beat.period_ms);
	TEST_ASSERT_EQUAL(1, door_rings(in.door, 0));
	TEST_ASSERT_EQUAL(0, ows_beat(h, 500));
	TEST_ASSERT_EQUAL(1, door_rings(in.door, 0));
	TEST_ASSERT_EQUAL(0, ows_beat(h, 500));
	TEST_ASSERT_EQUAL(0, door_rings(in.door, 0));
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL(3, beat.beat);
	TEST_ASSERT_EQUAL(500, beat.period_ms);
	TEST_ASSERT_FALSE(beat.goodbye);
}

static void test_closing_says_goodbye_and_hangs_up(void)
{
	struct controller_beat beat;
	struct ows *other;

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &other));
	ows_close(other);
	door_wait_gone(in.door, 1);
	controller_beat(instance_controller(&in, 1), &beat);
	TEST_ASSERT_TRUE(beat.goodbye);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_FALSE(beat.goodbye);
}

static void test_what_this_user_may_not_command_is_refused(void)
{
	slot_at(HEAT)->allowed = 0;
	TEST_ASSERT_EQUAL(-EACCES, ows_set(h, ows_find(h, "heat"), 1, NULL));
	TEST_ASSERT_EQUAL(-EACCES, ows_set_text(h, ows_find(h, "heat"), "1", NULL));
	TEST_ASSERT_EQUAL(-EACCES, ows_set(h, ows_find(h, "heat_RE"), 1, NULL));
	TEST_ASSERT_EQUAL(-EACCES, ows_set(h, ows_find(h, "heat_WOS"), 1, NULL));
	TEST_ASSERT_EQUAL(-EACCES, ows_acknowledge(h, ows_find(h, "heat")));
	TEST_ASSERT_EQUAL(-EACCES, ows_shelve(h, ows_find(h, "heat"), 60, "repair"));
	TEST_ASSERT_EQUAL(-1, next_dirty());
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "valve"), 1, NULL));
	slot_at(0)->allowed = 0;
	TEST_ASSERT_EQUAL(-EACCES, ows_set(h, ows_find(h, "_DGNRESET"), 1, NULL));
}

static void expect_void(void)
{
	const double value = 1;
	int heat = ows_find(h, "heat");

	TEST_ASSERT_EQUAL(-ESTALE, ows_set(h, heat, 0, NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_set_many(h, &heat, &value, 1));
	TEST_ASSERT_EQUAL(-ESTALE, ows_set_text(h, ows_find(h, "text"), "x", NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_set_integer(h, ows_find(h, "heat_WOS"), 1, NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_acknowledge(h, heat));
	TEST_ASSERT_EQUAL(-ESTALE, ows_shelve(h, heat, 60, NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_beat(h, 100));
	TEST_ASSERT_EQUAL(0, slot_at(HEAT)->stamp);
	TEST_ASSERT_EQUAL(0, slot_at(HEAT)->one_shot);
	TEST_ASSERT_EQUAL(0, slot_at(HEAT)->acknowledged);
	TEST_ASSERT_EQUAL(0, slot_at(TEXT)->stamp);
	TEST_ASSERT_EQUAL(0, header()->beat);
	TEST_ASSERT_EQUAL(-1, next_dirty());
}

static void test_a_retired_memory_takes_no_sets(void)
{
	controller_state(instance_controller(&in, 0), OWS_STATE_RETIRED);
	expect_void();
}

static void test_the_memory_of_a_stopped_owsd_takes_no_sets(void)
{
	controller_state(instance_controller(&in, 0), OWS_STATE_STOPPED);
	expect_void();
}

/* owsd gives the pages of a memory back when it ends. */
static void test_an_emptied_memory_takes_no_sets(void)
{
	memset(instance_controller(&in, 0)->base, 0, in.door->layout.header.size);
	expect_void();
}

static void test_nothing_is_set_while_owsds_heart_stands_still(void)
{
	instance_beat(&in, ows_now() - 2 * INSTANCE_PATIENCE, 0);
	expect_void();
	instance_beat(&in, ows_now(), 1);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat"), 1, NULL));
	instance_beat(&in, ows_now() + 3600 * INSTANCE_S, 2);
	TEST_ASSERT_EQUAL(-ESTALE, ows_set(h, ows_find(h, "heat"), 0, NULL));
}

/* What the child found: a bit for each check that failed, so that the parent's assert names it. */
static int look_as_child(void)
{
	int heat = ows_find(h, "heat"), wrong = 0;
	struct ows_value v;

	wrong |= ows_set(h, heat, 1, NULL) == -EPERM ? 0 : 1;
	wrong |= ows_set_text(h, ows_find(h, "text"), "x", NULL) == -EPERM ? 0 : 2;
	wrong |= ows_beat(h, 100) == -EPERM ? 0 : 4;
	wrong |= ows_for(h, "x") == -EPERM ? 0 : 8;
	wrong |= ows_reopen(h) == -EPERM ? 0 : 16;
	wrong |= ows_get(h, heat, ows_now(), &v) == 0 ? 0 : 32;
	wrong |= ows_acknowledge(h, heat) == -EPERM ? 0 : 64;
	ows_close(h);
	return wrong;
}

static void test_a_forked_child_commands_nothing_in_its_parents_name(void)
{
	struct controller_beat beat;
	pid_t child = fork();
	int status;

	if (child == 0)
		_exit(look_as_child());
	TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
	TEST_ASSERT_EQUAL(0, status);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_FALSE(beat.goodbye);
	TEST_ASSERT_EQUAL(0, beat.beat);
	TEST_ASSERT_EQUAL(0, load(HEAT).stamp);
	TEST_ASSERT_EQUAL(-1, next_dirty());
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat"), 1, NULL));
}

static void test_owsd_is_told_the_name_of_the_program(void)
{
	struct ows *other;

	TEST_ASSERT_EQUAL_STRING("test_set", door_controller(in.door, 0)->hello.name);
	TEST_ASSERT_EQUAL(OWS_HELLO_COMMAND, door_controller(in.door, 0)->hello.flags);
	TEST_ASSERT_EQUAL(0, ows_open_as(in.name, OWS_CONTROL,
	                                 "a name that is longer than thirty-one bytes", &other));
	TEST_ASSERT_EQUAL_STRING("a name that is longer than thir",
	                         door_controller(in.door, 1)->hello.name);
	ows_close(other);
}

static void expect_person(const char *expected)
{
	char name[OWS_NAME] = "";
	uint32_t person;

	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat"), 1, NULL));
	person = load(HEAT).person;
	if (person)
		controller_person(instance_controller(&in, 0), person, name);
	TEST_ASSERT_EQUAL_STRING(expected, name);
}

static void test_a_command_says_for_whom_it_is(void)
{
	expect_person("");
	TEST_ASSERT_EQUAL(0, ows_for(h, "anna"));
	expect_person("anna");
	TEST_ASSERT_EQUAL(0, ows_for(h, "bert"));
	expect_person("bert");
	TEST_ASSERT_EQUAL(-ERANGE, ows_for(h, "a name that is longer than thirty-one bytes"));
	expect_person("bert");
	TEST_ASSERT_EQUAL(0, ows_for(h, "anna"));
	expect_person("anna");
	TEST_ASSERT_EQUAL(0, ows_for(h, NULL));
	expect_person("");
}

static void test_a_person_is_replaced_only_when_owsd_has_looked(void)
{
	static const char *const own[] = {"heat", "valve", "text", "small"};
	static const uint32_t records[] = {HEAT, VALVE, TEXT, SMALL};
	char name[16];

	for (int i = 0; i < OWS_PERSONS; i++) {
		snprintf(name, sizeof(name), "person %d", i);
		TEST_ASSERT_EQUAL(0, ows_for(h, name));
	}
	/* Four of them command, and owsd does not look */
	for (int i = 0; i < 4; i++) {
		snprintf(name, sizeof(name), "person %d", i);
		TEST_ASSERT_EQUAL(0, ows_for(h, name));
		TEST_ASSERT_EQUAL(0, ows_set_text(h, ows_find(h, own[i]), "1", NULL));
	}
	for (int i = 0; i < 100; i++) {
		snprintf(name, sizeof(name), "guest %d", i);
		TEST_ASSERT_EQUAL(0, ows_for(h, name));
	}
	for (int i = 0; i < 4; i++) {
		char there[OWS_NAME];

		snprintf(name, sizeof(name), "person %d", i);
		controller_person(instance_controller(&in, 0), slot_at(records[i])->person, there);
		TEST_ASSERT_EQUAL_STRING(name, there);
	}
}

static void *shelve_as_owsd(void *arg)
{
	struct controller_memory *memory = arg;
	struct controller_shelf shelf;

	while (!controller_shelf(memory, &shelf))
		sched_yield();
	if (shelf.record != VALVE || shelf.seconds != 60 || strcmp(shelf.why, "repair") != 0)
		controller_shelf_done(memory, shelf.count, -EBADMSG);
	else
		controller_shelf_done(memory, shelf.count, -ENOSPC);
	return NULL;
}

static void test_shelving_waits_for_owsds_answer(void)
{
	pthread_t thread;

	TEST_ASSERT_EQUAL(
		0, pthread_create(&thread, NULL, shelve_as_owsd, instance_controller(&in, 0)));
	TEST_ASSERT_EQUAL(-ENOSPC, ows_shelve(h, ows_find(h, "valve"), 60, "repair"));
	pthread_join(thread, NULL);
	TEST_ASSERT_EQUAL(1, door_rings(in.door, 0));
}

static void test_shelving_gives_up_where_owsd_does_not_answer(void)
{
	char why[OWS_TEXT + 1];

	memset(why, 'x', OWS_TEXT);
	why[OWS_TEXT] = '\0';
	TEST_ASSERT_EQUAL(-ERANGE, ows_shelve(h, ows_find(h, "valve"), 60, why));
	TEST_ASSERT_EQUAL(-ENOENT, ows_shelve(h, ows_find(h, "_DGNRESET"), 60, "x"));
	TEST_ASSERT_EQUAL(-ETIMEDOUT, ows_shelve(h, ows_find(h, "valve"), 60, NULL));
	TEST_ASSERT_EQUAL(-EBUSY, ows_shelve(h, ows_find(h, "valve"), 60, NULL));
}

struct waker {
	unsigned wakes;
	bool stop;
};

static bool look(struct waker *w)
{
	struct controller_memory *memory = instance_controller(&in, 0);

	if (!controller_marked(memory))
		return false;
	while (controller_next_dirty(memory, 0) >= 0)
		__atomic_fetch_add(&w->wakes, 1, __ATOMIC_RELEASE);
	return true;
}

/* The engine's side of the bell: sleeps only after it looked. */
static void *engine(void *arg)
{
	struct waker *w = arg;
	struct pollfd bell = {.fd = door_controller(in.door, 0)->bell, .events = POLLIN};

	while (!__atomic_load_n(&w->stop, __ATOMIC_ACQUIRE)) {
		image_awake(&in.image, true);
		look(w);
		door_rings(in.door, 0);
		image_awake(&in.image, false);
		if (!look(w))
			poll(&bell, 1, -1);
	}
	return NULL;
}

static void test_no_ring_is_lost_between_awake_and_asleep(void)
{
	struct waker w = {0};
	pthread_t thread;
	int id = ows_find(h, "valve");

	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, engine, &w));
	for (unsigned i = 0; i < 5000; i++) {
		unsigned before = __atomic_load_n(&w.wakes, __ATOMIC_ACQUIRE);
		int64_t until = ows_now() + 60 * INSTANCE_S;

		TEST_ASSERT_EQUAL(0, ows_set(h, id, i, NULL));
		while (__atomic_load_n(&w.wakes, __ATOMIC_ACQUIRE) == before) {
			TEST_ASSERT_TRUE_MESSAGE(ows_now() < until, "the engine sleeps on");
			sched_yield();
		}
	}
	__atomic_store_n(&w.stop, true, __ATOMIC_RELEASE);
	TEST_ASSERT_EQUAL(0, ows_set(h, id, 0, NULL));
	pthread_join(thread, NULL);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_set_reaches_the_engine_with_stamp_mark_and_bell);
	RUN_TEST(test_an_engine_that_is_awake_needs_no_bell);
	RUN_TEST(test_each_set_of_a_handle_has_a_greater_stamp);
	RUN_TEST(test_what_owsd_took_and_confirmed_is_this_handles_own);
	RUN_TEST(test_what_was_confirmed_2_to_the_31_sets_ago_confirms_no_new_set);
	RUN_TEST(test_what_was_confirmed_before_a_start_stays_so);
	RUN_TEST(test_a_value_the_type_cannot_hold_is_refused);
	RUN_TEST(test_an_input_takes_no_sets);
	RUN_TEST(test_an_input_takes_sets_while_its_write_enable_is_on);
	RUN_TEST(test_nothing_of_writing_is_set_of_an_input_whose_writable_is_off);
	RUN_TEST(test_a_reader_may_not_set);
	RUN_TEST(test_enables_are_commanded_by_name);
	RUN_TEST(test_a_flag_acts_when_it_goes_from_off_to_on);
	RUN_TEST(test_of_many_values_all_are_set_with_one_ring_or_none);
	RUN_TEST(test_a_text_arrives_with_its_check_word);
	RUN_TEST(test_text_sets_a_number_too);
	RUN_TEST(test_a_beat_and_its_promise_reach_the_engine);
	RUN_TEST(test_closing_says_goodbye_and_hangs_up);
	RUN_TEST(test_what_this_user_may_not_command_is_refused);
	RUN_TEST(test_a_retired_memory_takes_no_sets);
	RUN_TEST(test_the_memory_of_a_stopped_owsd_takes_no_sets);
	RUN_TEST(test_an_emptied_memory_takes_no_sets);
	RUN_TEST(test_nothing_is_set_while_owsds_heart_stands_still);
	RUN_TEST(test_a_forked_child_commands_nothing_in_its_parents_name);
	RUN_TEST(test_owsd_is_told_the_name_of_the_program);
	RUN_TEST(test_a_command_says_for_whom_it_is);
	RUN_TEST(test_a_person_is_replaced_only_when_owsd_has_looked);
	RUN_TEST(test_shelving_waits_for_owsds_answer);
	RUN_TEST(test_shelving_gives_up_where_owsd_does_not_answer);
	RUN_TEST(test_no_ring_is_lost_between_awake_and_asleep);
	return UNITY_END();
}
