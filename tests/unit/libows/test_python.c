/* SPDX-License-Identifier: MIT */
/* ows.py: what libows says, in types of Python. Runs python3. */
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/memory/shm/entries.h"
#include "src/memory/shm/futex.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"
#include "tests/unit/aid/needs.h"

static const struct instance_signal signals[] = {
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 10 * INSTANCE_S, "28.000000000001"},
	{"relay", "/29.1/PIO.0", OWS_BOOL, true, 0},
	{"count", "/1D.1/counters.A", OWS_DWORD, true, 0},
	{"label", "/23.1/memory", OWS_STRING, true, 0},
	{"deep", "/20.1/x", OWS_LARGE, true, 0},
	{"room1_Age", "/28.2/temperature", OWS_FLOAT, false, 0, "28.000000000002"},
};
#define COUNT 6
enum { ROOM = 1, RELAY, NUMBER, LABEL, DEEP, ROOM_AGE };

static struct instance in;
static char output[4096];

void setUp(void)
{
	instance_start(&in, "python", signals, COUNT);
	output[0] = '\0';
}

void tearDown(void)
{
	instance_end(&in);
}

static FILE *python(const char *code)
{
	char whole[4096];
	int n = snprintf(whole, sizeof(whole),
	                 "name = sys.argv[1]\n"
	                 "def error(call, *a):\n"
	                 "    try:\n"
	                 "        call(*a)\n"
	                 "        return None\n"
	                 "    except Exception as e:\n"
	                 "        return type(e).__name__\n"
	                 "%s",
	                 code);

	TEST_ASSERT_LESS_THAN((int)sizeof(whole), n);
	return needs_python3_run(whole, in.name);
}

static void finish(FILE *run)
{
	size_t n = fread(output, 1, sizeof(output) - 1, run);

	output[n] = '\0';
	TEST_ASSERT_EQUAL_MESSAGE(0, pclose(run), output);
}

static void expect(const char *code, const char *expected)
{
	FILE *run = python(code);

	TEST_ASSERT_NOT_NULL(run);
	finish(run);
	TEST_ASSERT_EQUAL_STRING(expected, output);
}

static void test_python_reads_what_c_wrote(void)
{
	/* not stale however long python takes to start */
	instance_put_double(&in, ROOM, 21.5, ows_now() + INSTANCE_PATIENCE / 2);
	instance_put(&in, RELAY, 1, ows_now());
	instance_put(&in, NUMBER, 4294967295, ows_now());
	instance_put(&in, DEEP, INT64_MIN, ows_now());
	instance_put_text(&in, LABEL, "boiler \xc3\xa9", ows_now());
	instance_put_double(&in, ROOM_AGE, 55, ows_now());
	expect("s = ows.Ows(name)\n"
	       "for n in s.names(): print(n, s.get(n).value, s.get(n).good, s.get(n).type)",
	       "room1 21.5 True 8\nrelay True True 1\ncount 4294967295 True 6\n"
	       "label boiler \xc3\xa9 True 12\ndeep -9223372036854775808 True 10\n"
	       "room1_Age 55.0 True 7\n");
}

static void test_python_names_the_targets(void)
{
	image_target(&in.image, 0, 2, 3);
	image_moves(&in.image, 1, 5);
	image_note(&in.image, 1, 5, "the kernel's");
	instance_put_double(&in, ROOM, 21.5, ows_now());
	expect("s = ows.Ows(name)\nfor t in s.targets(): print(*t)\n"
	       "print(list(s.targets())[s.get(s.names()[0]).target].name)",
	       "0 localhost:4304 suspended 3 0 0 None\n1 w1 down 0 1 5 the kernel's\nw1\n");
}

static void test_its_signals_are_like_a_dictionary(void)
{
	instance_put_double(&in, ROOM, 21.5, ows_now());
	expect("s = ows.Ows(name)\n"
	       "print(*s, len(s), \"relay\" in s, \"nobody\" in s)\n"
	       "print(s[\"room1\"].value, s[\"room1_Value\"].value, s[name + \"__room1\"].value)\n"
	       "print(s.info(name + \"__room1\").path, s.info(\"relay\").type == ows.BOOL)\n"
	       "for n in (\"nobody\", \"\", \"ELSE__room1\", None): print(error(s.get, n))\n"
	       "try: s.get(\"raley\")\nexcept KeyError as e: print(e)\n"
	       "s.close()\n"
	       "print(error(s.get, \"room1\"), error(s.stale), error(s.close))",
	       "room1 relay count label deep room1_Age 6 True False\n21.5 21.5 21.5\n"
	       "/28.1/temperature True\nKeyError\nKeyError\nKeyError\nTypeError\n"
	       "'raley: did you mean relay?'\n"
	       "ValueError ValueError None\n");
}

/* What a person sees of a value; units are in tests/system/test_scaling.py. */
static void test_a_value_says_what_it_is_worth(void)
{
	instance_put_double(&in, ROOM, 21.5, ows_now() - 11 * INSTANCE_S);
	instance_put(&in, RELAY, 1, ows_now());
	expect("s = ows.Ows(name)\nn = s[\"relay\"].measured_ns + 10**8\n"
	       "print(s.get(\"relay\", n), repr(s[\"count\"]), s[\"room1\"].text, s[\"room1\"].good)\n"
	       "print(s.get(\"relay\", n + 63 * 10**9).text)",
	       "True, good, 0.1 s old <Value 0, bad, never measured> stale False\nowsd not running\n");
}

static void test_python_computes_attributes_as_c_does(void)
{
	struct ows_sample sample = {.measured_ns = 1000, .quality = OWS_Q_GOOD};
	struct ows_attrs attrs = {
		.transactions = 5,
		.update_ns = 2500000000,
		.age_max_ns = 3 * INSTANCE_S,
		.per_base = 0xfffffffeu,
		.per_max = 2,
		.pend_base = 0,
		.pend_last = 7,
		.pend_max = 9,
		.alarms = 1,
		.flags = OWS_ATTR_WRITE_ENABLE | OWS_ATTR_IN_WORK,
	};
	static const char *const names[] = {
		"relay_TRANSACTIONS", "relay_PerFactor", "relay_PerCount", "relay_PerMax",
		"relay_PendCount",    "relay_PendLast",  "relay_PendMax",  "relay_Period",
		"relay_RE",           "relay_WE",        "relay_Alarm",    "relay_Alarm",
		"_TRANSACTIONS",      "_RECONNECTS",
	};
	char expected[sizeof(output)] = "", code[2048] = "s = ows.Ows(name)\nfor n in (";
	size_t used = 0;
	struct ows *h;

	image_publish(&in.image, RELAY, &sample, &attrs, NULL);
	instance_beat(&in, ows_now(), 4);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &h));
	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		struct ows_value v;

		TEST_ASSERT_EQUAL(0, ows_get(h, ows_find(h, names[i]), ows_now(), &v));
		strcat(strcat(strcat(code, "\""), names[i]), "\",");
		used += (size_t)snprintf(expected + used, sizeof(expected) - used, "%s %.6f %d\n",
		                         names[i], v.number, v.type);
	}
	ows_close(h);
	strcat(code, "): v = s.get(n); print(n, \"%.6f\" % v.value, v.type)\n"
	             "print(error(s.get, \"relay_WOS\"), error(s.get, \"_DGNRESET\"))");
	snprintf(expected + used, sizeof(expected) - used, "PermissionError PermissionError\n");
	expect(code, expected);
}

static struct controller_command load(uint32_t slot)
{
	return instance_command(&in, 0, slot);
}

static struct ows_command_slot *slot_at(uint32_t record)
{
	return instance_slot(&in, 0, record);
}

static void test_c_finds_what_python_set(void)
{
	char text[INSTANCE_TEXT + 1], person[OWS_NAME];
	struct controller_command relay;
	struct controller_beat beat;

	/* as NumPy's whole numbers are */
	expect("class Deep:\n"
	       "    def __index__(self): return 1 - 2**63\n"
	       "    def __float__(self): return -2.0**63\n"
	       "s = ows.Ows(name, control=True, name=\"plc\")\n"
	       "for wrong in (0, 3600001):\n"
	       "    try: s.beat(wrong); print(\"taken\")\n"
	       "    except ValueError: pass\n"
	       "s.beat(3600000)\ns.beat(700)\n"
	       "print(s.set(\"relay\", \"on\"), s.set(\"relay\", 0.0), s.set(\"count\", 4294967295))\n"
	       "s.for_person(\"anna\")\n"
	       "print(s.set(\"deep\", Deep()), s.set(\"label\", \"north\"))\n"
	       "s.set(\"relay_RE\", 1); s.set(\"relay_WE\", 0)\n"
	       "for level in (1, 1, 0, 1): s.set(\"relay_WOS\", level)\n"
	       "s.set(\"_DGNRESET\", 1)\n"
	       "sys.stdout.flush(); import os; os._exit(0)",
	       "1 2 3\n4 5\n");
	TEST_ASSERT_EQUAL_STRING("plc", door_controller(in.door, 0)->hello.name);
	TEST_ASSERT_EQUAL(2, slot_at(RELAY)->one_shot);
	TEST_ASSERT_EQUAL(1, slot_at(0)->dgn_reset);
	relay = load(RELAY);
	TEST_ASSERT_EQUAL_INT64(0, relay.value);
	TEST_ASSERT_EQUAL(2, relay.stamp);
	TEST_ASSERT_EQUAL(2, relay.read_enable);
	TEST_ASSERT_EQUAL(1, relay.write_enable);
	TEST_ASSERT_EQUAL_INT64(4294967295, load(NUMBER).value);
	TEST_ASSERT_EQUAL(0, load(NUMBER).person);
	TEST_ASSERT_EQUAL_INT64(INT64_MIN + 1, load(DEEP).value);
	TEST_ASSERT_EQUAL(1, load(DEEP).person);
	controller_person(instance_controller(&in, 0), 1, person);
	TEST_ASSERT_EQUAL_STRING("anna", person);
	TEST_ASSERT_EQUAL(5, controller_text(instance_controller(&in, 0), LABEL, text));
	TEST_ASSERT_EQUAL_STRING("north", text);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL(2, beat.beat); /* and none that is refused */
	TEST_ASSERT_EQUAL(700, beat.period_ms);
	TEST_ASSERT_FALSE_MESSAGE(beat.goodbye, "it ended without close()");
	TEST_ASSERT_GREATER_THAN(0, door_rings(in.door, 0));
	TEST_ASSERT_TRUE(controller_marked(instance_controller(&in, 0)));
	for (int i = 0; i <= LABEL + 1; i++)
		if (i != ROOM)
			TEST_ASSERT_EQUAL(i, controller_next_dirty(instance_controller(&in, 0), 0));
	TEST_ASSERT_EQUAL(-1, controller_next_dirty(instance_controller(&in, 0), 0));
}

static void test_python_says_goodbye(void)
{
	struct controller_beat beat;

	expect("with ows.Ows(name, control=True) as s: s.beat(500)", "");
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_TRUE(beat.goodbye);
	TEST_ASSERT_EQUAL_STRING("-c", door_controller(in.door, 0)->hello.name);
}

static void test_python_commands_nothing_after_a_fork(void)
{
	expect("import os\n"
	       "s = ows.Ows(name, control=True)\n"
	       "if os.fork() == 0:\n"
	       "    print(error(s.set, \"relay\", 1), error(s.beat, 100), error(s.reopen),"
	       " s.get(\"relay\").type, flush=True)\n"
	       "    s.close()\n"
	       "    os._exit(0)\n"
	       "os.wait()\n"
	       "print(s.set(\"relay\", 1))\n"
	       "os._exit(0) if sys.stdout.flush() is None else 0",
	       "PermissionError PermissionError PermissionError 1\n1\n");
	TEST_ASSERT_EQUAL(1, load(RELAY).stamp);
}

static void test_python_sees_what_owsd_took_and_who_commands(void)
{
	const struct ows_who who = {.serial = 1, .uid = 1000, .pid = 4711, .name = "plc"};
	const struct ows_who other = {
		.serial = 7, .uid = 1001, .pid = 4712, .name = "hmi", .person = "anna"};
	struct ows_origin_entry origin = {.reason = OWS_REASON_SET, .taken_ns = 5, .who = who};
	struct ows_controller_entry controller = {
		.flags = OWS_CONTROLLER_CONNECTED | OWS_CONTROLLER_LATE,
		.joined_ns = 6,
		.who = other,
		.period_ms = 300,
		.commands = 8,
		.refused = 9,
	};

	image_origin(&in.image, RELAY, &origin);
	origin.reason = OWS_REASON_SAFE;
	origin.who = other;
	image_origin(&in.image, NUMBER, &origin);
	image_controller(&in.image, 3, &controller);
	expect("s = ows.Ows(name, control=True)\n"
	       "for n in (\"relay\", \"count\", \"deep\"): print(*s.origin(n))\n"
	       "print(*[tuple(g) for g in s.controllers()])\n",
	       "By(serial=1, uid=1000, pid=4711, name='plc', person='') 5 set True\n"
	       "By(serial=7, uid=1001, pid=4712, name='hmi', person='anna') 5 SafeValue False\n"
	       "By(serial=0, uid=0, pid=0, name='', person='') 0 none False\n"
	       "(By(serial=7, uid=1001, pid=4712, name='hmi', person='anna'), 6, 300, 8, 9, False,"
	       " True)\n");
}

static void test_python_reads_what_owsd_knows_of_devices(void)
{
	const struct ows_device_entry known = {.target = 1,
	                                       .answers = 0x100000001,
	                                       .errors = 2,
	                                       .retries = 3,
	                                       .wire_us = 4,
	                                       .ok_ns = 5,
	                                       .power = OWS_POWER_PARASITE,
	                                       .identity = "DS18B20 clone, family B1"};
	const struct ows_device_entry unknown = {.target = UINT32_MAX, .power = 9};

	image_device(&in.image, 0, &known);
	image_device(&in.image, 1, &unknown);
	expect("for d in ows.Ows(name).devices(): print(*d, sep=\"|\")\n",
	       "28.000000000001|DS18B20|DS18B20 clone, family B1|parasite|1|4294967297|2|3|4|5\n"
	       "28.000000000002|DS18B20|None|None|None|0|0|0|0|0\n");
}

static void test_python_says_in_a_sentence_why_it_opens_nothing(void)
{
	static const struct {
		enum door_lie lie;
		const char *error;
	} lies[] = {
		{DOOR_NO_FDS, "OSError no segment of owsd, or of another version\n"},
		{DOOR_REFUSES,
	         "PermissionError no right to set the signals of python: that is for group "
	         "owsd-control, or for whom ControlAllow names\n"},
		{DOOR_SILENT, "TimeoutError Connection timed out\n"},
		{DOOR_HANGS_UP, "NotRunning no owsd of the name python runs\n"},
	};

	for (size_t i = 0; i < sizeof(lies) / sizeof(lies[0]); i++) {
		door_lie(in.door, lies[i].lie);
		expect("try: ows.Ows(name, True)\n"
		       "except OSError as e:\n"
		       "    print(type(e).__name__, e.strerror.replace(name, \"python\"))",
		       lies[i].error);
	}
	expect("try: ows.Ows(\"no-such\")\nexcept FileNotFoundError as e: print(e)",
	       "no owsd of the name no-such runs\n");
}

static void test_python_refuses_what_c_refuses(void)
{
	expect("s = ows.Ows(name, control=True)\n"
	       "for n, v in ((\"room1\", 1), (\"relay\", 2), (\"count\", 1.5), (\"count\", -1),"
	       " (\"label\", \"x\" * 65), (\"room1_Age_Age\", 1), (\"nobody\", 1), (\"deep\", 2**63),"
	       " (\"relay\", None), (\"relay\", b\"1\"), (\"relay\", \"maybe\"), (\"label\", 1),"
	       " (\"label\", \"a\\0b\")):"
	       " print(n, error(s.set, n, v))\n"
	       "try: s.set(\"relay\", 2)\nexcept ValueError as e: print(e)\n"
	       "print(error(ows.Ows(name).set, \"relay\", 1), error(s.beat, 0), error(s.beat, -1))",
	       "room1 PermissionError\nrelay ValueError\ncount ValueError\ncount ValueError\n"
	       "label ValueError\nroom1_Age_Age PermissionError\nnobody KeyError\ndeep ValueError\n"
	       "relay TypeError\nrelay TypeError\nrelay ValueError\nlabel TypeError\n"
	       "label ValueError\nrelay: a bool cannot hold 2\n"
	       "PermissionError ValueError ValueError\n");
	TEST_ASSERT_EQUAL(0, load(RELAY).stamp);
	TEST_ASSERT_EQUAL(-1, controller_next_dirty(instance_controller(&in, 0), 0));
}

static void test_python_finds_its_way_over_a_reload(void)
{
	FILE *run = python("s = ows.Ows(name, control=True)\n"
	                   "print(s.stale(), s.set(\"relay\", 1), flush=True)\n"
	                   "try:\n"
	                   "    news = 0\n"
	                   "    while True: news = s.wait(news, 20)\n"
	                   "except ows.Stale: print(\"stale\", s.stale(), s.get(\"relay\").good)\n"
	                   "print(error(s.set, \"relay\", 0), error(s.beat, 1000),"
	                   " error(s.acknowledge, \"relay\"))\n"
	                   "s.reopen()\n"
	                   "print(s.stale(), s.set(\"relay\", 0), s.get(\"relay\").quality)");
	char first[64];

	TEST_ASSERT_NOT_NULL(run);
	TEST_ASSERT_NOT_NULL(fgets(first, sizeof(first), run));
	TEST_ASSERT_EQUAL_STRING("False 1\n", first);
	instance_reload(&in, signals, COUNT);
	finish(run);
	TEST_ASSERT_EQUAL_STRING("stale True False\nStale Stale Stale\nFalse 2 0\n", output);
}

static void test_python_gives_each_change_once_and_says_when_it_fell_behind(void)
{
	in.image.header->change_head = UINT32_MAX - 1; /* their numbers wrap */
	instance_put(&in, RELAY, 1, ows_now());
	instance_put_text(&in, LABEL, "x", ows_now());
	instance_put(&in, RELAY, 0, ows_now());
	expect("s = ows.Ows(name)\n"
	       "c = s.changes(0)\n"
	       "n = next(c)\n"
	       "print(n.everything, len(n), len(next(c)))\n"
	       "c.cursor.number -= 3\n"
	       "n = next(c)\n"
	       "print(n.everything, *n, len(next(c)))\n"
	       "c.cursor.number -= 5000\n"
	       "n = next(c)\n"
	       "print(n.everything, len(n), len(next(c)))",
	       "True 6 0\nFalse relay label 0\nTrue 6 0\n");
}

static void expect_line(FILE *run, const char *expected)
{
	char line[128];

	TEST_ASSERT_NOT_NULL(fgets(line, sizeof(line), run));
	TEST_ASSERT_EQUAL_STRING(expected, line);
}

static void test_python_follows_changes_over_a_loss_of_owsd_and_a_reload(void)
{
	FILE *run = python("s = ows.Ows(name)\n"
	                   "c = s.changes(60)\n"
	                   "def show(n): print(n.everything, *n, flush=True)\n"
	                   "for i in range(4): show(next(c))\n"
	                   "print(error(next, c), flush=True)\n"
	                   "s.reopen()\n"
	                   "for i in range(2): show(next(c))");

	TEST_ASSERT_NOT_NULL(run);
	expect_line(run, "True room1 relay count label deep room1_Age\n");
	instance_put(&in, NUMBER, 1, ows_now());
	segment_wake(&in.image.header->news, 1000);
	expect_line(run, "False count\n");
	instance_beat(&in, ows_now() - INSTANCE_PATIENCE - INSTANCE_S, 0);
	segment_wake(&in.image.header->news, 1000);
	expect_line(run, "True room1 relay count label deep room1_Age\n");
	instance_beat(&in, ows_now(), 0);
	segment_wake(&in.image.header->news, 1000);
	expect_line(run, "True room1 relay count label deep room1_Age\n");
	instance_reload(&in, signals, COUNT - 1);
	instance_lives_on(&in);
	expect_line(run, "Stale\n");
	expect_line(run, "True room1 relay count label deep\n");
	instance_put(&in, DEEP, 1, ows_now());
	finish(run);
	TEST_ASSERT_EQUAL_STRING("False deep\n", output);
}

static void test_python_reads_the_journal_of_alarms(void)
{
	struct ows_journal_entry entry = {
		.record = ROOM,
		.occurred_ns = 5,
		.before = value_of_double(21.5),
		.kind = OWS_ALARM_HH,
		.event = OWS_ALARM_RAISED,
		.quality = OWS_Q_GOOD,
		.flags = OWS_JOURNAL_BEFORE,
	};

	for (int i = 0; i < OWS_JOURNAL + 1; i++)
		image_alarm(&in.image, &entry);
	entry = (struct ows_journal_entry){
		.record = RELAY,
		.occurred_ns = 6,
		.kind = OWS_ALARM_DEVICE,
		.event = OWS_ALARM_RETURNED,
		.text = "1,0",
	};
	image_alarm_after(&in.image, image_alarm(&in.image, &entry), 1);
	in.image.alarms[5].seq++;
	expect("s = ows.Ows(name)\n"
	       "all = list(s.alarms())\n"
	       "print(len(all), all[0].number, 5 in [a.number for a in all])\n"
	       "print(*all[0][1:])\n"
	       "print(*[list(a) for a in s.alarms(257)])\n"
	       "print(list(s.alarms(258)))\n",
	       "255 2 False\n"
	       "room1 5 21.5 None high high raised 192  By(serial=0, uid=0, pid=0, name='', person='')\n"
	       "[257, 'relay', 6, None, True, 'device', 'returned', 0, '1,0',"
	       " By(serial=0, uid=0, pid=0, name='', person='')]\n"
	       "[]\n");
}

static void test_c_finds_what_python_acknowledged(void)
{
	struct ows_sample sample = {.quality = OWS_Q_GOOD};
	struct ows_attrs attrs = {
		.alarms = 3,
		.flags = OWS_ATTR_LIMITS | OWS_ATTR_ALARM_STANDS,
		.limit_state = OWS_LIMIT_RETURNED,
		.limit_condition = OWS_ALARM_LL,
	};

	image_publish(&in.image, ROOM, &sample, &attrs, NULL);
	expect("s = ows.Ows(name, control=True)\n"
	       "print(*s.alarm_state(\"room1\"), sep=\",\")\n"
	       "s.acknowledge(\"room1\")\n"
	       "print(error(s.acknowledge, \"_TRANSACTIONS\"),"
	       " error(ows.Ows(name).acknowledge, \"room1\"))",
	       "3,True,False,True,returned to normal unacknowledged,low low,None,None\n"
	       "KeyError PermissionError\n");
	TEST_ASSERT_TRUE(load(ROOM).acknowledged);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_python_reads_what_c_wrote);
	RUN_TEST(test_python_names_the_targets);
	RUN_TEST(test_its_signals_are_like_a_dictionary);
	RUN_TEST(test_a_value_says_what_it_is_worth);
	RUN_TEST(test_python_computes_attributes_as_c_does);
	RUN_TEST(test_c_finds_what_python_set);
	RUN_TEST(test_python_says_goodbye);
	RUN_TEST(test_python_commands_nothing_after_a_fork);
	RUN_TEST(test_python_sees_what_owsd_took_and_who_commands);
	RUN_TEST(test_python_reads_what_owsd_knows_of_devices);
	RUN_TEST(test_python_says_in_a_sentence_why_it_opens_nothing);
	RUN_TEST(test_python_refuses_what_c_refuses);
	RUN_TEST(test_python_finds_its_way_over_a_reload);
	RUN_TEST(test_python_gives_each_change_once_and_says_when_it_fell_behind);
	RUN_TEST(test_python_follows_changes_over_a_loss_of_owsd_and_a_reload);
	RUN_TEST(test_python_reads_the_journal_of_alarms);
	RUN_TEST(test_c_finds_what_python_acknowledged);
	return UNITY_END();
}
