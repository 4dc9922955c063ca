/* SPDX-License-Identifier: MIT */
/* Tests of what clients may command, and of how they are called. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/faces/modbus/writing.h"
#include "src/memory/shm/entries.h"
#include "tests/unit/aid/instance.h"

#define S INSTANCE_S

static const struct instance_signal signals[] = {
	{"pump", "/29.1/PIO.0", OWS_BOOL, true, 0},
	{"room", "/28.1/temperature", OWS_DOUBLE, false, 0},
};
enum { PUMP = 1, ROOM, COUNT };

static struct instance in;
static struct config config;
static struct face_arguments arguments;
static const struct face_ops ops = {.program = "owsd-modbus"};
static struct face face;
static struct writing w;
static struct listen_address plc, other;
static struct config_item safe = {.name = "pump", .has_safe = true};

void setUp(void)
{
	const char *why;
	struct listen_address both[2];

	instance_start(&in, "modbus", signals, COUNT - 1);
	config = (struct config){.modbus = {.write = true,
	                                    .allow = "pump 10.0.0.5, room 10.0.0.5",
	                                    .beat_ns = 3 * S}};
	arguments.instance = in.name;
	face = (struct face){.ops = &ops, .arguments = &arguments, .config = &config};
	face.log = log_create(LOG_LEVEL_ERR);
	face.live = ows_open(in.name, OWS_READ, &face.ows) == 0;
	w = (struct writing){.face = &face};
	TEST_ASSERT_EQUAL_INT(1, listen_parse("10.0.0.5:4000", 13, both, &why));
	plc = both[0];
	TEST_ASSERT_EQUAL_INT(1, listen_parse("10.0.0.6:4000", 13, both, &why));
	other = both[0];
}

void tearDown(void)
{
	for (unsigned i = 0; i < WRITERS; i++)
		face_way_close(&w.writers[i].way);
	ows_close(face.ows);
	log_destroy(face.log);
	instance_end(&in);
}

/* The command of the pump is in force, as owsd has it. */
static void in_force(const char *person, enum ows_reason reason)
{
	struct ows_origin_entry entry = {.reason = (uint32_t)reason, .taken_ns = ows_now()};

	snprintf(entry.who.person, sizeof(entry.who.person), "%s", person);
	image_origin(&in.image, PUMP, &entry);
	config.items = &safe;
	config.item_count = 1;
}

static enum exception set(const char *name, double number, const struct listen_address *from,
                          int64_t came_ns)
{
	w.names[0] = name;
	w.numbers[0] = number;
	w.count = 1;
	return writing_set(&w, from, came_ns);
}

static enum exception heard(const struct listen_address *from, bool by_register)
{
	return writing_heard(&w, from, ows_now(), by_register);
}

static void test_a_client_is_a_controller_that_beats_as_long_as_it_asks(void)
{
	struct controller_beat beat;
	uint32_t before;

	heard(&plc, false); /* it has not commanded */
	TEST_ASSERT_EQUAL_UINT(0, instance_controllers(&in));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 1, &plc, ows_now()));
	TEST_ASSERT_EQUAL_UINT(1, instance_controllers(&in));
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL_UINT(3000, beat.period_ms);
	before = beat.beat;
	heard(&other, false);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL_UINT(before, beat.beat);
	plc.port = 4001; /* another connection of it */
	heard(&plc, false);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL_UINT(before + 1, beat.beat);
	/* from its first beat in the register on, that alone counts */
	heard(&plc, true);
	heard(&plc, false);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL_UINT(before + 2, beat.beat);
	/* what has waited says nothing of now */
	TEST_ASSERT_EQUAL_INT(EXCEPTION_BUSY, writing_heard(&w, &plc, ows_now() - 3 * S, true));
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL_UINT(before + 2, beat.beat);
	config.modbus.write = false;
	heard(&plc, true);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL_UINT(before + 2, beat.beat);
	TEST_ASSERT_EQUAL_UINT64(1, w.taken);
}

static void test_a_beat_by_register_counts_alone_also_if_it_came_before_the_first_command(void)
{
	struct controller_beat beat;
	uint32_t before;

	heard(&plc, true);
	TEST_ASSERT_EQUAL_UINT(0, instance_controllers(&in));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 1, &plc, ows_now()));
	controller_beat(instance_controller(&in, 0), &beat);
	before = beat.beat;
	heard(&plc, false);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL_UINT(before, beat.beat);
}

static void test_a_promise_that_the_file_ends_is_taken_back(void)
{
	struct controller_beat beat;

	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 1, &plc, ows_now()));
	config.modbus.beat_ns = 0;
	heard(&plc, false);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_TRUE(beat.goodbye);
	TEST_ASSERT_NULL(w.writers[0].way.h);
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 0, &plc, ows_now()));
	TEST_ASSERT_EQUAL_INT64(0, w.writers[0].promised_ns);
}

static void test_what_is_refused_is_so_by_the_exception_that_fits(void)
{
	TEST_ASSERT_EQUAL_INT(EXCEPTION_VALUE, set("pump", 2.5, &plc, ows_now()));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_ADDRESS, set("nothing", 1, &plc, ows_now()));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_BUSY, set("pump", 1, &plc, ows_now() - 3 * S));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_FAILURE, writing_refusal(-EACCES));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_ADDRESS, writing_refusal(-EROFS));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_BUSY, writing_refusal(-ESTALE));
}

static void test_an_address_that_owsd_has_lost_gives_its_place_to_another(void)
{
	struct controller_beat beat;

	for (uint8_t i = 0; i < WRITERS; i++) {
		other.bytes[3] = (uint8_t)(100 + i);
		TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 1, &other, ows_now()));
	}
	TEST_ASSERT_EQUAL_INT(EXCEPTION_BUSY, set("pump", 1, &plc, ows_now()));
	w.writers[7].heard_ns -= 10 * S;
	in_force("modbus:10.0.0.107", OWS_REASON_SET);
	TEST_ASSERT_EQUAL_INT(EXCEPTION_BUSY, set("pump", 1, &plc, ows_now()));
	in_force("modbus:10.0.0.100", OWS_REASON_SET);
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 1, &plc, ows_now()));
	TEST_ASSERT_EQUAL_UINT(WRITERS + 1, instance_controllers(&in));
	controller_beat(instance_controller(&in, 7), &beat);
	TEST_ASSERT_TRUE(beat.goodbye);
	other.bytes[3] = 107; /* it is back, and no place is free */
	TEST_ASSERT_EQUAL_INT(EXCEPTION_BUSY, set("pump", 1, &other, ows_now()));
	other.bytes[3] = 108;
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 1, &other, ows_now()));
	/* without Beat nothing was promised */
	for (unsigned i = 0; i < WRITERS; i++)
		w.writers[i].promised_ns = 0;
	other.bytes[3] = 107;
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 1, &other, ows_now()));
}

static void test_who_is_lost_is_no_controller_any_more_until_it_commands_again(void)
{
	struct controller_beat beat;
	int64_t now_ns = ows_now(), next_ns;

	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 1, &plc, now_ns));
	next_ns = writing_tick(&w, now_ns);
	TEST_ASSERT_TRUE(next_ns > now_ns && next_ns < now_ns + 10 * S);
	TEST_ASSERT_NOT_NULL(w.writers[0].way.h);
	w.writers[0].heard_ns -= 10 * S;
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, writing_tick(&w, now_ns));
	TEST_ASSERT_NULL(w.writers[0].way.h);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_TRUE(beat.goodbye);
	heard(&plc, false);
	TEST_ASSERT_NULL(w.writers[0].way.h);
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 0, &plc, ows_now()));
	TEST_ASSERT_EQUAL_UINT(2, instance_controllers(&in));
}

/* owsd may have stood still, or wait for SafeDelay: a goodbye now would leave the pump on. */
static void test_nobody_says_goodbye_before_owsd_has_written_safevalue(void)
{
	struct controller_beat beat;
	int64_t now_ns = ows_now();

	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 1, &plc, now_ns));
	w.writers[0].heard_ns -= 100 * S;
	in_force("modbus:10.0.0.5", OWS_REASON_SET);
	TEST_ASSERT_EQUAL_INT64(now_ns + S, writing_tick(&w, now_ns));
	in_force("modbus:10.0.0.5", OWS_REASON_RETURNED);
	TEST_ASSERT_EQUAL_INT64(now_ns + S, writing_tick(&w, now_ns));
	in_force("modbus:10.0.0.5", OWS_REASON_SAFE);
	face.live = false;
	TEST_ASSERT_EQUAL_INT64(now_ns + S, writing_tick(&w, now_ns));
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_FALSE(beat.goodbye);
	face.live = true;
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, writing_tick(&w, now_ns));
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_TRUE(beat.goodbye);
}

static void test_a_number_has_to_fit_before_any_is_set(void)
{
	struct ows_info info = {.name = "pump", .type = OWS_BOOL, .min = NAN, .max = NAN};

	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, writing_add(&w, &info, 1, &plc));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_VALUE, writing_add(&w, &info, 0.5, &plc));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_VALUE, writing_add(&w, &info, 2, &plc));
	info.type = OWS_DOUBLE;
	info.min = -10;
	info.max = 25.5;
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, writing_add(&w, &info, -10, &plc));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, writing_add(&w, &info, 25.5, &plc));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_VALUE, writing_add(&w, &info, 25.6, &plc));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_VALUE, writing_add(&w, &info, -10.1, &plc));
	TEST_ASSERT_EQUAL_INT(3, w.count);
	TEST_ASSERT_EQUAL_UINT(0, instance_controllers(&in));
}

static void test_what_owsd_refuses_leaves_all_else_of_the_request_as_it_is(void)
{
	static const char *const wrong[] = {"room", "nothing"};

	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 0, &plc, ows_now()));
	for (size_t i = 0; i < 2; i++) {
		w.names[0] = "pump";
		w.names[1] = wrong[i];
		w.numbers[0] = w.numbers[1] = 1;
		w.count = 2;
		TEST_ASSERT_NOT_EQUAL(EXCEPTION_NONE, writing_set(&w, &plc, ows_now()));
		TEST_ASSERT_EQUAL_INT64(0, instance_command(&in, 0, PUMP).value);
		TEST_ASSERT_EQUAL_UINT32(1, instance_command(&in, 0, PUMP).stamp);
	}
	w.names[1] = "pump";
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, writing_set(&w, &plc, ows_now()));
	TEST_ASSERT_EQUAL_INT64(1, instance_command(&in, 0, PUMP).value);
	TEST_ASSERT_EQUAL_UINT64(3, w.taken);
}

static void test_a_client_may_what_the_configuration_says(void)
{
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, writing_may(&w, NULL, &other));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, writing_may(&w, "pump", &plc));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_ADDRESS, writing_may(&w, "pump", &other));
	TEST_ASSERT_EQUAL_INT(EXCEPTION_ADDRESS, writing_may(&w, "valve", &plc));
	config.modbus.write = false;
	TEST_ASSERT_EQUAL_INT(EXCEPTION_FUNCTION, writing_may(&w, "pump", &plc));
}

static void test_a_client_that_promised_a_beat_is_lost_at_the_end_and_says_no_goodbye(void)
{
	struct controller_beat beat;

	TEST_ASSERT_EQUAL_INT(EXCEPTION_NONE, set("pump", 1, &plc, ows_now()));
	writing_close(&w);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_FALSE(beat.goodbye);
	config.modbus.beat_ns = 0;
	writing_close(&w);
	TEST_ASSERT_NULL(w.writers[0].way.h);
}

static void test_a_person_has_the_end_of_a_long_address(void)
{
	struct listen_address both[2];
	char person[WRITING_PERSON];
	const char *why, *text = "[2001:db8:1111:2222:3333:4444:5555:6666]:1";

	TEST_ASSERT_EQUAL_STRING("modbus:10.0.0.5", writing_person(&plc, person));
	TEST_ASSERT_EQUAL_INT(1, listen_parse(text, strlen(text), both, &why));
	TEST_ASSERT_EQUAL_STRING("modbus:2222:3333:4444:5555:6666", writing_person(both, person));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_client_is_a_controller_that_beats_as_long_as_it_asks);
	RUN_TEST(test_a_beat_by_register_counts_alone_also_if_it_came_before_the_first_command);
	RUN_TEST(test_a_promise_that_the_file_ends_is_taken_back);
	RUN_TEST(test_what_is_refused_is_so_by_the_exception_that_fits);
	RUN_TEST(test_an_address_that_owsd_has_lost_gives_its_place_to_another);
	RUN_TEST(test_who_is_lost_is_no_controller_any_more_until_it_commands_again);
	RUN_TEST(test_nobody_says_goodbye_before_owsd_has_written_safevalue);
	RUN_TEST(test_a_number_has_to_fit_before_any_is_set);
	RUN_TEST(test_what_owsd_refuses_leaves_all_else_of_the_request_as_it_is);
	RUN_TEST(test_a_client_may_what_the_configuration_says);
	RUN_TEST(test_a_client_that_promised_a_beat_is_lost_at_the_end_and_says_no_goodbye);
	RUN_TEST(test_a_person_has_the_end_of_a_long_address);
	return UNITY_END();
}
