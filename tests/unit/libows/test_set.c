/* SPDX-License-Identifier: MIT */
/* Tests of setting outputs and attributes by libows. */
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/shm/futex.h"
#include "src/signal/value.h"
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

static struct command load(uint32_t slot)
{
	struct command c;

	commands_load(&in.commands, slot, &c);
	return c;
}

static struct ows_client *client_at(unsigned client)
{
	return (struct ows_client *)(void *)(in.commands.base + in.commands.client_off) + client;
}

static void test_a_set_reaches_the_engine_with_stamp_mark_and_bell(void)
{
	uint32_t stamp, bell = *commands_bell(&in.commands);

	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "valve"), 0.25, &stamp));
	TEST_ASSERT_EQUAL(1, stamp);
	TEST_ASSERT_EQUAL_INT64(value_of_double(0.25), load(VALVE).value);
	TEST_ASSERT_EQUAL(1, load(VALVE).stamp);
	TEST_ASSERT_EQUAL(0, load(VALVE).client);
	TEST_ASSERT_NOT_EQUAL(bell, *commands_bell(&in.commands));
	TEST_ASSERT_EQUAL(VALVE, commands_next_dirty(&in.commands, 0));
	TEST_ASSERT_EQUAL(-1, commands_next_dirty(&in.commands, 0));
}

static void test_a_value_the_type_cannot_hold_is_refused(void)
{
	TEST_ASSERT_EQUAL(-ERANGE, ows_set(h, ows_find(h, "small"), 256, NULL));
	TEST_ASSERT_EQUAL(-ERANGE, ows_set_integer(h, ows_find(h, "small"), -1, NULL));
	TEST_ASSERT_EQUAL(-EINVAL, ows_set(h, ows_find(h, "valve"), (double)NAN, NULL));
	TEST_ASSERT_EQUAL(-EINVAL, ows_set(h, ows_find(h, "valve"), (double)INFINITY, NULL));
	TEST_ASSERT_EQUAL(0, load(SMALL).stamp);
	TEST_ASSERT_EQUAL(0, load(VALVE).stamp);
	TEST_ASSERT_EQUAL(-1, commands_next_dirty(&in.commands, 0));
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
	ows_close(reader);
}

static void test_enables_are_commanded_by_name(void)
{
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat_RE"), 1, NULL));
	TEST_ASSERT_EQUAL(0, ows_set_integer(h, ows_find(h, "heat_WriteEnable"), 0, NULL));
	TEST_ASSERT_EQUAL(2, load(HEAT).read_enable);
	TEST_ASSERT_EQUAL(1, load(HEAT).write_enable);
	TEST_ASSERT_EQUAL(0, load(HEAT).stamp);
	TEST_ASSERT_EQUAL(HEAT, commands_next_dirty(&in.commands, 0));
}

static void test_a_flag_acts_when_it_goes_from_off_to_on(void)
{
	int shot = ows_find(h, "heat_WOS"), reset = ows_find(h, "_DGNRESET");

	for (int i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL(0, ows_set(h, shot, 1, NULL));
	TEST_ASSERT_EQUAL(1, load(HEAT).one_shot);
	TEST_ASSERT_EQUAL(0, ows_set(h, shot, 0, NULL));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat_WriteOneShot"), 1, NULL));
	TEST_ASSERT_EQUAL(2, load(HEAT).one_shot);
	TEST_ASSERT_EQUAL(0, ows_set(h, reset, 1, NULL));
	TEST_ASSERT_EQUAL(0, ows_set(h, reset, 1, NULL));
	TEST_ASSERT_EQUAL(1, load(0).dgn_reset);
	TEST_ASSERT_EQUAL(0, load(HEAT).dgn_reset);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat_DGNRESET"), 1, NULL));
	TEST_ASSERT_EQUAL(1, load(HEAT).dgn_reset);
}

static void test_many_values_ring_once(void)
{
	int ids[3] = {ows_find(h, "heat"), ows_find(h, "valve"), ows_find(h, "small")};
	double values[3] = {1, 2.5, 300};
	uint32_t bell = *commands_bell(&in.commands);

	TEST_ASSERT_EQUAL(2, ows_set_many(h, ids, values, 3));
	TEST_ASSERT_EQUAL(bell + 1, *commands_bell(&in.commands));
	TEST_ASSERT_EQUAL(-ERANGE, ows_set_many(h, ids + 2, values + 2, 1));
	TEST_ASSERT_EQUAL(0, ows_set_many(h, ids, values, 0));
}

static void test_a_text_arrives_with_its_check_word(void)
{
	char text[INSTANCE_TEXT + 1];
	char longest[INSTANCE_TEXT + 2];
	int id = ows_find(h, "text");

	TEST_ASSERT_EQUAL(0, ows_set_text(h, id, "on the hill", NULL));
	TEST_ASSERT_EQUAL(11, commands_text(&in.commands, TEXT, text));
	TEST_ASSERT_EQUAL_STRING("on the hill", text);
	memset(longest, 'x', sizeof(longest));
	longest[INSTANCE_TEXT + 1] = '\0';
	TEST_ASSERT_EQUAL(-ERANGE, ows_set_text(h, id, longest, NULL));
	longest[INSTANCE_TEXT] = '\0';
	TEST_ASSERT_EQUAL(0, ows_set_text(h, id, longest, NULL));
	TEST_ASSERT_EQUAL(INSTANCE_TEXT, commands_text(&in.commands, TEXT, text));
	TEST_ASSERT_EQUAL(0, ows_set_text(h, id, "", NULL));
	TEST_ASSERT_EQUAL(0, commands_text(&in.commands, TEXT, text));
}

static void test_a_claimed_text_is_busy_until_the_engine_frees_it(void)
{
	struct ows_command_text *t = (void *)(in.commands.base + in.commands.text_off[TEXT]);
	char text[INSTANCE_TEXT + 1];
	int id = ows_find(h, "text");

	t->claim = 4711;
	TEST_ASSERT_EQUAL(-EBUSY, ows_set_text(h, id, "x", NULL));
	TEST_ASSERT_EQUAL(-EBUSY, commands_text(&in.commands, TEXT, text));
	commands_unclaim(&in.commands, TEXT);
	TEST_ASSERT_EQUAL(0, ows_set_text(h, id, "x", NULL));
}

static void test_text_sets_a_number_too(void)
{
	TEST_ASSERT_EQUAL(0, ows_set_text(h, ows_find(h, "heat"), "on", NULL));
	TEST_ASSERT_EQUAL_INT64(1, load(HEAT).value);
	TEST_ASSERT_NOT_EQUAL(0, ows_set_text(h, ows_find(h, "valve"), "warm", NULL));
	TEST_ASSERT_NOT_EQUAL(0, ows_set(h, ows_find(h, "text"), 1, NULL));
}

static void test_who_beats_is_named_in_what_he_sets(void)
{
	struct command_client c;

	TEST_ASSERT_EQUAL(0, ows_beat(h, 500));
	TEST_ASSERT_EQUAL(0, ows_beat(h, 500));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat"), 1, NULL));
	TEST_ASSERT_EQUAL(1, load(HEAT).client);
	commands_client(&in.commands, 0, &c);
	TEST_ASSERT_EQUAL(getpid(), c.pid);
	TEST_ASSERT_EQUAL(2, c.beat);
	TEST_ASSERT_EQUAL(500, c.period_ms);
}

static void test_who_was_dropped_comes_back_with_his_next_beat(void)
{
	struct command_client c;

	TEST_ASSERT_EQUAL(0, ows_beat(h, 500));
	commands_drop_client(&in.commands, 0);
	TEST_ASSERT_EQUAL(0, ows_beat(h, 500));
	commands_client(&in.commands, 0, &c);
	TEST_ASSERT_EQUAL(getpid(), c.pid);
}

static void test_who_was_dropped_sets_nothing_in_the_name_of_the_next_one(void)
{
	TEST_ASSERT_EQUAL(0, ows_beat(h, 500));
	commands_drop_client(&in.commands, 0);
	client_at(0)->pid = (uint32_t)getpid() + 1; /* another process takes the place */
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat"), 1, NULL));
	TEST_ASSERT_EQUAL(0, load(HEAT).client);
	TEST_ASSERT_EQUAL(0, ows_beat(h, 500));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat"), 1, NULL));
	TEST_ASSERT_EQUAL(2, load(HEAT).client);
}

static void test_who_ends_in_order_leaves_commands_that_are_nobodys(void)
{
	struct command_client c;
	struct ows *other;

	TEST_ASSERT_EQUAL(0, ows_beat(h, 500));
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &other));
	TEST_ASSERT_EQUAL(0, ows_beat(other, 500));
	TEST_ASSERT_EQUAL(0, ows_set(other, ows_find(other, "heat"), 1, NULL));
	TEST_ASSERT_EQUAL(0, ows_set_text(other, ows_find(other, "text"), "on", NULL));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "valve"), 1, NULL));
	TEST_ASSERT_EQUAL(2, load(TEXT).client);
	ows_close(other);
	TEST_ASSERT_EQUAL(0, load(HEAT).client);
	TEST_ASSERT_EQUAL(0, load(TEXT).client);
	TEST_ASSERT_EQUAL(1, load(HEAT).stamp);
	TEST_ASSERT_EQUAL(1, load(VALVE).client);
	commands_client(&in.commands, 1, &c);
	TEST_ASSERT_EQUAL(0, c.pid);
}

static void test_the_table_of_clients_has_an_end(void)
{
	struct ows *many[OWS_CLIENTS + 1];
	int i;

	for (i = 0; i <= OWS_CLIENTS; i++)
		TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &many[i]));
	for (i = 0; i < OWS_CLIENTS; i++)
		TEST_ASSERT_EQUAL(0, ows_beat(many[i], 100));
	TEST_ASSERT_EQUAL(-ENOSPC, ows_beat(many[i], 100));
	ows_close(many[0]);
	TEST_ASSERT_EQUAL(0, ows_beat(many[i], 100));
	for (i = 1; i <= OWS_CLIENTS; i++)
		ows_close(many[i]);
}

static void test_a_retired_segment_takes_no_sets(void)
{
	commands_state(&in.commands, OWS_STATE_RETIRED);
	TEST_ASSERT_EQUAL(-ESTALE, ows_set(h, ows_find(h, "heat"), 1, NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_beat(h, 100));
}

static void test_the_segment_of_a_stopped_owsd_takes_no_sets_and_keeps_what_was_in_force(void)
{
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat"), 1, NULL));
	commands_state(&in.commands, OWS_STATE_STOPPED);
	TEST_ASSERT_EQUAL(-ESTALE, ows_set(h, ows_find(h, "heat"), 0, NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_set_text(h, ows_find(h, "text"), "x", NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_set_integer(h, ows_find(h, "heat_WOS"), 1, NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_acknowledge(h, ows_find(h, "heat")));
	TEST_ASSERT_EQUAL(-ESTALE, ows_beat(h, 100));
	TEST_ASSERT_EQUAL_INT64(1, load(HEAT).value);
	TEST_ASSERT_EQUAL(1, load(HEAT).stamp);
	TEST_ASSERT_EQUAL(0, load(HEAT).one_shot);
	TEST_ASSERT_EQUAL(0, load(HEAT).acknowledged);
	TEST_ASSERT_EQUAL(0, load(TEXT).stamp);
}

static void test_a_consumer_survives_the_truncation_by_another(void)
{
	/* The sanitizers have a handler of their own, which libows leaves alone */
	struct sigaction by_default = {.sa_handler = SIG_DFL};

	TEST_ASSERT_EQUAL(0, sigaction(SIGBUS, &by_default, NULL));
	ows_close(h);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
	TEST_ASSERT_EQUAL(0, ftruncate(in.command_memory.fd, 0));
	TEST_ASSERT_EQUAL(-ESTALE, ows_set(h, ows_find(h, "heat"), 1, NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_set_text(h, ows_find(h, "heat"), "1", NULL));
	TEST_ASSERT_EQUAL(-ENOENT, ows_reopen(h));
	TEST_ASSERT_EQUAL(-ESTALE, ows_beat(h, 100));
}

struct waker {
	unsigned wakes;
	bool stop;
};

/* The engine's side of the bell: sleeps only after it looked. */
static void *engine(void *arg)
{
	struct waker *w = arg;
	uint32_t *bell = commands_bell(&in.commands);

	while (!__atomic_load_n(&w->stop, __ATOMIC_ACQUIRE)) {
		uint32_t seen;

		commands_awake(&in.commands, true);
		while (commands_next_dirty(&in.commands, 0) >= 0)
			__atomic_fetch_add(&w->wakes, 1, __ATOMIC_RELEASE);
		seen = __atomic_load_n(bell, __ATOMIC_ACQUIRE);
		commands_awake(&in.commands, false);
		if (commands_next_dirty(&in.commands, 0) >= 0) {
			__atomic_fetch_add(&w->wakes, 1, __ATOMIC_RELEASE);
			continue;
		}
		segment_wait(bell, seen, -1);
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
	RUN_TEST(test_a_value_the_type_cannot_hold_is_refused);
	RUN_TEST(test_an_input_takes_no_sets);
	RUN_TEST(test_an_input_takes_sets_while_its_write_enable_is_on);
	RUN_TEST(test_nothing_of_writing_is_set_of_an_input_whose_writable_is_off);
	RUN_TEST(test_a_reader_may_not_set);
	RUN_TEST(test_enables_are_commanded_by_name);
	RUN_TEST(test_a_flag_acts_when_it_goes_from_off_to_on);
	RUN_TEST(test_many_values_ring_once);
	RUN_TEST(test_a_text_arrives_with_its_check_word);
	RUN_TEST(test_a_claimed_text_is_busy_until_the_engine_frees_it);
	RUN_TEST(test_text_sets_a_number_too);
	RUN_TEST(test_who_beats_is_named_in_what_he_sets);
	RUN_TEST(test_who_was_dropped_comes_back_with_his_next_beat);
	RUN_TEST(test_who_was_dropped_sets_nothing_in_the_name_of_the_next_one);
	RUN_TEST(test_who_ends_in_order_leaves_commands_that_are_nobodys);
	RUN_TEST(test_the_table_of_clients_has_an_end);
	RUN_TEST(test_a_retired_segment_takes_no_sets);
	RUN_TEST(test_the_segment_of_a_stopped_owsd_takes_no_sets_and_keeps_what_was_in_force);
	RUN_TEST(test_a_consumer_survives_the_truncation_by_another);
	RUN_TEST(test_no_ring_is_lost_between_awake_and_asleep);
	return UNITY_END();
}
