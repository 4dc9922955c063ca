/* SPDX-License-Identifier: MIT */
/* The verbs on an instance without owsd: what they print, and their exit status. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/memory/shm/entries.h"
#include "src/memory/shm/futex.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/rows.h"
#include "src/tool/owsctl/verbs.h"
#include "tests/unit/aid/caught.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 10 * INSTANCE_S},
	{"relay", "/29.1/PIO.0", OWS_BOOL, true, 0},
	{"count", "/1D.1/counters.A", OWS_LARGE, false, 0},
	{"label", "/23.1/memory", OWS_STRING, true, 0},
	{"level", "/29.2/PIO.BYTE", OWS_BYTE, true, 0},
};
#define COUNT 5

static struct instance in;

void setUp(void)
{
	int64_t now = ows_now();

	instance_start(&in, "verbs", signals, COUNT);
	instance_put_double(&in, 1, 21.5, now);
	instance_put(&in, 2, 1, now);
	instance_put(&in, 3, INT64_C(9007199254740993), now);
	instance_put_text(&in, 4, "a \"b\"\n", now);
	caught_begin(in.name);
}

void tearDown(void)
{
	instance_end(&in);
	caught_end();
}

static void test_get_prints_the_values_alone(void)
{
	char words[128];

	snprintf(words, sizeof(words), "get room1 count %s__relay room1_PerFactor", in.name);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_get, words));
	TEST_ASSERT_EQUAL_STRING("21.5\n9007199254740993\n1\n1\n", out);
	TEST_ASSERT_EQUAL_STRING("", err);
}

static void test_get_writes_strings_into_a_pipe_as_they_are(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_get, "get label"));
	TEST_ASSERT_EQUAL_STRING("a \"b\"\n\n", out);
}

static void test_get_of_a_value_that_is_not_good_is_status_3(void)
{
	TEST_ASSERT_EQUAL(CTL_NOT_GOOD, run(verb_get, "get level room1"));
	TEST_ASSERT_EQUAL_STRING("\n21.5\n", out);
	holds(err, "level has no value: ");
	holds(err, "never measured");
}

static void test_what_was_commanded_is_shown_as_the_value_is(void)
{
	char text[COMMANDED_WORDS];

	TEST_ASSERT_EQUAL_STRING("50.7 \u00b0C",
	                         commanded_text(OWS_DOUBLE, "50.7125", 1, "\u00b0C", text));
	TEST_ASSERT_EQUAL_STRING("50.7125", commanded_text(OWS_DOUBLE, "50.7125", -1, "", text));
	TEST_ASSERT_EQUAL_STRING("9007199254740993 l",
	                         commanded_text(OWS_LARGE, "9007199254740993", 1, "l", text));
}

static void test_get_of_an_unknown_name_is_status_1_and_suggests(void)
{
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_get, "get rom1 level"));
	holds(err, "there is no rom1; did you mean room1?");
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_get, "get relay_WOS"));
	holds(err, "relay_WOS can only be set");
}

static void test_get_of_a_dead_owsd_says_that_it_is_dead(void)
{
	instance_beat(&in, ows_now() - 60 * INSTANCE_S, 0);
	TEST_ASSERT_EQUAL(CTL_NOT_GOOD, run(verb_get, "get room1"));
	TEST_ASSERT_EQUAL_STRING("21.5\n", out);
	holds(err, "is not running: last heartbeat 60s ago");
}

static void test_get_of_an_owsd_whose_heart_beats_in_the_future_says_so(void)
{
	instance_beat(&in, ows_now() + 3600 * INSTANCE_S, 0);
	TEST_ASSERT_EQUAL(CTL_NOT_GOOD, run(verb_get, "get room1"));
	TEST_ASSERT_EQUAL_STRING("21.5\n", out);
	holds(err, "is not running: its heartbeat lies in the future");
}

static void test_get_without_a_name_is_wrong_usage(void)
{
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_get, "get"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_get, "get -x room1"));
	holds(err, "unknown option: -x");
}

static void test_no_instance_is_told(void)
{
	caught_ctl.instance = "nobody.runs.this";
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_get, "get room1"));
	holds(err, "no owsd of the name nobody.runs.this");
}

static void test_json_of_get_is_an_array_with_exact_integers(void)
{
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_get, "get room1 count label nobody --json"));
	TEST_ASSERT_EQUAL_STRING_LEN("[{\"name\":\"room1\",\"value\":21.5,\"type\":\"double\","
	                             "\"good\":true,\"quality\":\"good\",\"quality_code\":192,",
	                             out, 80);
	holds(out, "\"value\":9007199254740993,");
	holds(out, "\"value\":\"a \\\"b\\\"\\n\",");
	holds(out, "{\"name\":\"nobody\",\"value\":null,\"good\":false,"
	           "\"error\":\"no such name\"}]\n");
}

static void test_list_shows_what_matches(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_list, "list r*"));
	holds(out, "NAME   VALUE  QUALITY");
	holds(out, "room1   21.5  good");
	holds(out, "relay    1    good");
	TEST_ASSERT_NULL(strstr(out, "count"));
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_list, "list x*"));
	holds(err, "no signal matches x*");
	/* one that matches nothing beside one that does is no failure, and is named */
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_list, "list r* nosuch"));
	holds(out, "relay    1    good");
	TEST_ASSERT_EQUAL_STRING("owsctl: no signal matches nosuch\n", err);
}

static void test_list_shows_driver_signals_when_asked(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_list, "list"));
	TEST_ASSERT_NULL(strstr(out, "_TRANSACTIONS"));
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_list, "list -a"));
	holds(out, "_TRANSACTIONS");
	holds(out, "_RECONNECTS");
}

/* What the owsctl that ran last commanded. */
static struct ows_command_slot *commanded(uint32_t record)
{
	return instance_slot(&in, instance_controllers(&in) - 1, record);
}

static void test_set_commands_outputs(void)
{
	char text[INSTANCE_TEXT + 1];

	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_set, "set relay off level 200 label hello"));
	TEST_ASSERT_EQUAL_STRING("", err);
	TEST_ASSERT_EQUAL(1, commanded(2)->stamp);
	TEST_ASSERT_EQUAL(2, commanded(5)->stamp);
	TEST_ASSERT_EQUAL_INT64(0, commanded(2)->value);
	TEST_ASSERT_EQUAL_INT64(200, commanded(5)->value);
	TEST_ASSERT_EQUAL(
		5,
		controller_text(instance_controller(&in, instance_controllers(&in) - 1), 4, text));
	TEST_ASSERT_EQUAL_STRING("hello", text);
}

static void test_set_sets_nothing_when_one_of_its_values_is_wrong(void)
{
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set relay 1 level 256"));
	holds(err, "level: \"256\" is no value for it: expected 0 to 255");
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set relay 1 level high"));
	holds(err, "level: \"high\" is no value for it: expected 0 to 255");
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set relay 1 room1_Age 0"));
	holds(err, "room1_Age cannot be set, only read");
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set relay 1 rely 0"));
	holds(err, "did you mean relay?");
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set relay 1 level 5 relay 0"));
	holds(err, "relay is set twice: nothing was set");
	TEST_ASSERT_EQUAL(0, commanded(2)->stamp);
}

static void test_set_of_an_input_is_refused(void)
{
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set room1 20"));
	holds(err, "room1 is not writable");
}

static void test_set_needs_names_and_values_in_pairs(void)
{
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_set, "set"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_set, "set relay"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_set, "set relay 1 level"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_set, "set -w soon relay 1"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_set, "set relay 1 -w"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_set, "set relay -w 20"));
	holds(err, "20 needs a value");
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_set, "set relay 1 -x"));
	holds(err, "unknown option: -x");
}

static void test_set_takes_options_behind_values_and_values_with_a_minus(void)
{
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set level -5"));
	holds(err, "level: \"-5\" is no value for it: expected 0 to 255");
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set -- level -w"));
	holds(err, "level: \"-w\" is no value for it: expected 0 to 255");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_set, "set relay 0 --json level 7"));
	holds(out, "{\"name\":\"level\",\"set\":\"7\"");
	TEST_ASSERT_EQUAL_INT64(7, commanded(5)->value);
}

static void test_set_makes_an_edge_each_time(void)
{
	for (uint32_t i = 1; i <= 3; i++) {
		TEST_ASSERT_EQUAL(CTL_DONE, run(verb_set, "set relay_WOS 1"));
		TEST_ASSERT_EQUAL_UINT32(1, commanded(2)->one_shot);
		TEST_ASSERT_EQUAL(i, instance_controllers(&in));
	}
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_set, "set relay_WOS 0"));
	TEST_ASSERT_EQUAL_UINT32(0, commanded(2)->one_shot);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_set, "set _DGNRESET 1"));
	TEST_ASSERT_EQUAL_UINT32(1, commanded(0)->dgn_reset);
}

static void test_set_while_owsd_is_dead_fails_and_says_why(void)
{
	instance_beat(&in, ows_now() - 60 * INSTANCE_S, 0);
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set relay 0"));
	holds(err, "owsd is not running: nothing was set");
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set -w 0.05 relay 0"));
	holds(err, "owsd is not running: nothing was set");
	instance_kill(&in);
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set relay 0"));
	holds(err, "is not running: nothing was set");
}

static void test_set_that_is_not_confirmed_says_why(void)
{
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_set, "set -w 0.05 relay 0"));
	holds(err, "relay was not confirmed: writing is disabled (relay_WriteEnable is 0)");
}

/* Confirms whatever is commanded, as the engine does, until it is told to end. */
static int ended;
static void *confirm(void *arg)
{
	const struct timespec pause = {.tv_nsec = 5000000};

	(void)arg;
	while (!__atomic_load_n(&ended, __ATOMIC_ACQUIRE)) {
		struct ows_attrs attrs = {.flags = OWS_ATTR_WRITE_ENABLE};
		struct ows_sample sample = {.measured_ns = ows_now(), .quality = OWS_Q_GOOD};
		unsigned controllers = instance_controllers(&in);

		if (controllers > 0) {
			struct controller_command command = instance_command(&in, controllers - 1,
			                                                     2);

			sample.value = command.value;
			controller_taken(instance_controller(&in, controllers - 1), 2,
			                 command.stamp, 0);
			controller_applied(instance_controller(&in, controllers - 1), 2,
			                   command.stamp);
		}
		image_publish(&in.image, 2, &sample, &attrs, NULL);
		image_news(&in.image);
		segment_wake(&in.image.header->news, 1000);
		nanosleep(&pause, NULL); /* pace */
	}
	return NULL;
}

static void test_set_waits_until_it_is_confirmed(void)
{
	pthread_t thread;

	__atomic_store_n(&ended, 0, __ATOMIC_RELEASE);
	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, confirm, NULL));
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_set, "set --json -w 20 relay 0"));
	TEST_ASSERT_EQUAL_STRING("[{\"name\":\"relay\",\"set\":\"0\",\"confirmed\":true}]\n", out);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_set, "set relay 0 -w 20 --json"));
	TEST_ASSERT_EQUAL_STRING("[{\"name\":\"relay\",\"set\":\"0\",\"confirmed\":true}]\n", out);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_wait, "wait relay = off -t 20"));
	TEST_ASSERT_EQUAL_STRING("0\n", out);
	__atomic_store_n(&ended, 1, __ATOMIC_RELEASE);
	pthread_join(thread, NULL);
}

static void test_wait_ends_at_once_when_the_condition_holds(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_wait, "wait room1 > 21"));
	TEST_ASSERT_EQUAL_STRING("21.5\n", out);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_wait, "wait room1 > -5 --json"));
	holds(out, "\"came\":true");
}

static void test_wait_ends_when_the_time_is_over(void)
{
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_wait, "wait room1 > 30 -t 0.02"));
	holds(err, "the time is over");
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_wait, "wait -t 0.02 room1"));
	TEST_ASSERT_EQUAL(CTL_NOT_GOOD, run(verb_wait, "wait -t 0.02 level = 0"));
}

static void test_wait_refuses_what_is_no_condition(void)
{
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_wait, "wait"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_wait, "wait room1 >"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_wait, "wait room1 over 25"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_wait, "wait room1 > warm"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_wait, "wait label > a"));
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_wait, "wait rom1"));
}

static void test_watch_prints_a_line_for_each_signal(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_watch, "watch -t 0"));
	holds(out, " room1 21.5 good\n");
	holds(out, " label \"a \\\"b\\\"\\n\" good\n");
	holds(out, " count 9007199254740993 good\n");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_watch, "watch -c 1 --json count"));
	TEST_ASSERT_EQUAL_STRING_LEN("{\"time\":\"", out, 9);
	holds(out, "\"value\":9007199254740993,");
}

static void test_watch_refuses_a_count_that_is_none(void)
{
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_watch, "watch -c 0"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_watch, "watch -c many"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_watch, "watch -t -1"));
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_watch, "watch nobody"));
}

static void test_stats_show_owsd_targets_and_counters(void)
{
	image_target(&in.image, 0, 1, 2);
	image_counter(&in.image, 1, UINT64_C(5000000000));
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_stats, "stats"));
	holds(out, ", live\n");
	holds(out, "signals     5, 1 not good\n");
	holds(out, "localhost:4304: up, 2 reconnects, wire 0, ");
	/* what is 0 comes last of all */
	holds(out, "  5000000000  keepalives of localhost:4304\n\n           0  alarms\n");
	TEST_ASSERT_EQUAL_STRING("           0  alarms\n", out + strlen(out) - 21);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_stats, "stats --json"));
	holds(out, "\"counters\":[{\"name\":\"alarms\",\"target\":null,\"value\":0},"
	           "{\"name\":\"keepalives\",\"target\":\"localhost:4304\",\"value\":5000000000}]");
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_stats, "stats more"));
}

static void test_stats_have_the_note_of_a_target(void)
{
	image_target(&in.image, 0, 1, 2);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_stats, "stats --json"));
	holds(out, "\"note\":null");
	image_note(&in.image, 0, ows_now() - 90 * INSTANCE_S, "another program uses it");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_stats, "stats"));
	holds(out, "localhost:4304: up, 2 reconnects, wire 0, ");
	holds(out, "\n            for 90s: another program uses it\n");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_stats, "stats --json"));
	holds(out, "\"note\":\"another program uses it\"");
}

static void test_metrics_have_one_family_for_the_counters_of_all_targets(void)
{
	image_target(&in.image, 0, 1, 2);
	image_counter(&in.image, 1, UINT64_C(5000000000));
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_metrics, "metrics"));
	holds(out, "ows_up{owsd=\"");
	holds(out, "# TYPE ows_keepalives counter\n");
	holds(out, ",target=\"localhost:4304\"} 5000000000\n");
	holds(out, "\n# EOF\n");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_metrics, "metrics -p"));
	holds(out, "# TYPE ows_keepalives_total counter\n");
	TEST_ASSERT_NULL(strstr(out, "# EOF"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_metrics, "metrics -x"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_metrics, "metrics --json"));
}

static void test_json_of_one_object_names_instance_and_machine(void)
{
	char host[65] = "", part[400];

	gethostname(host, sizeof(host) - 1);
	snprintf(part, sizeof(part), "{\"instance\":\"%s\",\"host\":\"%s\",", in.name, host);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_stats, "stats --json"));
	TEST_ASSERT_EQUAL_STRING_LEN(part, out, strlen(part));
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_who, "who --json"));
	TEST_ASSERT_EQUAL_STRING_LEN(part, out, strlen(part));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_get_prints_the_values_alone);
	RUN_TEST(test_get_writes_strings_into_a_pipe_as_they_are);
	RUN_TEST(test_get_of_a_value_that_is_not_good_is_status_3);
	RUN_TEST(test_what_was_commanded_is_shown_as_the_value_is);
	RUN_TEST(test_get_of_an_unknown_name_is_status_1_and_suggests);
	RUN_TEST(test_get_of_a_dead_owsd_says_that_it_is_dead);
	RUN_TEST(test_get_of_an_owsd_whose_heart_beats_in_the_future_says_so);
	RUN_TEST(test_get_without_a_name_is_wrong_usage);
	RUN_TEST(test_no_instance_is_told);
	RUN_TEST(test_json_of_get_is_an_array_with_exact_integers);
	RUN_TEST(test_list_shows_what_matches);
	RUN_TEST(test_list_shows_driver_signals_when_asked);
	RUN_TEST(test_set_commands_outputs);
	RUN_TEST(test_set_sets_nothing_when_one_of_its_values_is_wrong);
	RUN_TEST(test_set_of_an_input_is_refused);
	RUN_TEST(test_set_needs_names_and_values_in_pairs);
	RUN_TEST(test_set_takes_options_behind_values_and_values_with_a_minus);
	RUN_TEST(test_set_makes_an_edge_each_time);
	RUN_TEST(test_set_while_owsd_is_dead_fails_and_says_why);
	RUN_TEST(test_set_that_is_not_confirmed_says_why);
	RUN_TEST(test_set_waits_until_it_is_confirmed);
	RUN_TEST(test_wait_ends_at_once_when_the_condition_holds);
	RUN_TEST(test_wait_ends_when_the_time_is_over);
	RUN_TEST(test_wait_refuses_what_is_no_condition);
	RUN_TEST(test_watch_prints_a_line_for_each_signal);
	RUN_TEST(test_watch_refuses_a_count_that_is_none);
	RUN_TEST(test_stats_show_owsd_targets_and_counters);
	RUN_TEST(test_stats_have_the_note_of_a_target);
	RUN_TEST(test_metrics_have_one_family_for_the_counters_of_all_targets);
	RUN_TEST(test_json_of_one_object_names_instance_and_machine);
	return UNITY_END();
}
