/* SPDX-License-Identifier: MIT */
/*
 * Segments recorded from an earlier release, read by today's libows, ows.py and owsctl, value by
 * value. Runs python3 and owsctl in the directory of the sources. `test_recorded record` writes the
 * recording again: only for a new file.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/shm/carry.h"
#include "tests/unit/aid/recorded_readers.h"
#include "tests/unit/aid/recording.h"

static char here[128];

void setUp(void)
{
	recording_begin();
}

void tearDown(void)
{
	recording_end();
}

static void test_libows_reads_a_recorded_image(void)
{
	struct ows_daemon daemon;
	struct ows *h;

	TEST_ASSERT_EQUAL(0, ows_open(instance, OWS_READ, &h));
	check_all(h);
	TEST_ASSERT_EQUAL(0, ows_daemon(h, NOW_NS, &daemon));
	TEST_ASSERT_EQUAL(4321, daemon.pid);
	TEST_ASSERT_EQUAL(7, daemon.generation);
	TEST_ASSERT_EQUAL_INT64(START_NS, daemon.start_ns);
	TEST_ASSERT_EQUAL_INT64(S / 10, daemon.period_ns);
	TEST_ASSERT_TRUE(daemon.alive);
	ows_close(h);
}

static void test_what_was_commanded_is_carried_from_a_recorded_segment(void)
{
	char recorded[SIZE_MAX_], text[TEXT_CAP + 1];
	uint32_t size = read_recording("command", recorded);
	struct command c;

	make_commands();
	commands_put(&commands, BYTE_, 0, NULL, 0);
	commands_stamp(&commands, BYTE_, 0);
	commands_put(&commands, STRING_, 0, "", 0);
	TEST_ASSERT_EQUAL(3, commands_carry(&commands, recorded, size, true));
	commands_load(&commands, BYTE_, &c);
	TEST_ASSERT_EQUAL_INT64(254, c.value);
	TEST_ASSERT_EQUAL(202, c.stamp);
	commands_load(&commands, LARGE_, &c);
	TEST_ASSERT_EQUAL_INT64(INT64_MIN + 1, c.value);
	TEST_ASSERT_EQUAL(5, commands_text(&commands, STRING_, text));
	TEST_ASSERT_EQUAL_STRING("north", text);
}

static void test_a_recorded_segment_can_be_commanded(void)
{
	uint32_t stamp;
	struct ows *h;

	TEST_ASSERT_EQUAL(0, ows_open(instance, OWS_CONTROL, &h));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "byte"), 7, &stamp));
	TEST_ASSERT_EQUAL(203, stamp);
	TEST_ASSERT_EQUAL(0, ows_set_text(h, ows_find(h, "label"), "south", &stamp));
	TEST_ASSERT_EQUAL(211, stamp);
	TEST_ASSERT_EQUAL(0, ows_acknowledge(h, ows_find(h, "room.temperature")));
	ows_close(h);
}

/*
 * What readers in other languages rely on: not one byte elsewhere, as long as this is the layout.
 */
static void test_todays_writer_lays_the_same_out_in_the_same_way(void)
{
	char recorded[SIZE_MAX_];
	uint32_t size = read_recording("image", recorded);

	if (((const struct ows_image_header *)(const void *)recorded)->minor != OWS_LAYOUT_MINOR)
		TEST_IGNORE_MESSAGE("the recording is of an earlier minor version");
	make_image();
	TEST_ASSERT_EQUAL(size, image.header->size);
	TEST_ASSERT_EQUAL_MEMORY(recorded, image_memory, size);
	size = read_recording("command", recorded);
	make_commands();
	TEST_ASSERT_EQUAL(size, commands.size);
	TEST_ASSERT_EQUAL_MEMORY(recorded, command_memory, size);
}

static void test_python_reads_a_recorded_image(void)
{
	TEST_ASSERT_EQUAL_STRING(
		"bool|True|192|1|1.0|101|201|0|1|1009000000000|1009500000000\n"
		"byte|255|192|2|2.0|102|202|0|0|1008000000000|1009000000000\n"
		"short|-32768|12|3|3.0|103|203|-5|1|1007000000000|1008500000000\n"
		"long|-2147483648|20|0|4.0|104|204|0|0|1006000000000|1008000000000\n"
		"word|65535|86|1|5.0|105|205|0|1|1005000000000|1007500000000\n"
		"dword|4294967295|192|2|6.0|106|206|0|0|1004000000000|1007000000000\n"
		"float|45.5|192|3|7.0|107|207|0|1|1003000000000|1006500000000\n"
		"room.temperature|-21.0625|192|0|8.0|108|208|0|0|1002000000000|1006000000000\n"
		"large|-9223372036854775808|192|1|9.0|109|209|0|1|1001000000000|1005500000000\n"
		"label|" LONG_TEXT "|192|2|10.0|110|210|0|0|1000000000000|1005000000000\n"
		"empty||192|3|11.0|111|211|0|1|999000000000|1004500000000\n"
		"never|False|0|0|10.0|0|0|0|0|0|0\n",
		python("s = ows.Ows(sys.argv[1])\n"
	               "for n in s.names():\n"
	               "    v = s.get(n, 1010 * 10**9)\n"
	               "    print(n, v.value, v.quality, v.detail, v.age, v.count, v.applied, v.err,"
	               " v.target, v.measured_ns, v.tried_ns, sep=\"|\")\n"));
	TEST_ASSERT_EQUAL_STRING(
		"5000000002 0.5 2.0 200.0 2 3 10 402 10 True False 77 3\n"
		"0 localhost:4304 suspended 4 0 0\n"
		"1 i2c:/dev/i2c-1 up 5 0 6\n"
		"0 never 1001000000000 False True device raised 192 1,0,0,1\n"
		"1 room.temperature 1002000000000 30.5 None high high acknowledged 192 \n"
		"0 False False True returned to normal unacknowledged high high False\n"
		"Info(name=\"long\", path=\"/1D.000000000001/a\", type=4, output=False, fresh=True,"
		" alarm=False, per_factor=4, stale_after_ns=2000000000)\n",
		python("s = ows.Ows(sys.argv[1])\nN = 1010 * 10**9\n"
	               "print(*(s.get(\"byte_\" + a, N).value for a in (\"TRANSACTIONS\", \"Period\", \"Age\","
	               " \"AgeMax\", \"PerCount\", \"PerMax\", \"PendCount\", \"PendLast\", \"PendMax\","
	               " \"ReadEnable\", \"WE\")), s.get(\"_TRANSACTIONS\", N).value,"
	               " s.get(\"_RECONNECTS\", N).value)\n"
	               "for t in s.targets(): print(*t)\n"
	               "for a in s.alarms(): print(*a)\n"
	               "print(*s.alarm_state(\"room.temperature\"))\n"
	               "print(str(s.info(\"long\")).replace(chr(39), chr(34)))\n"));
}

/* Its clock is the real one, for which this owsd died long ago: no value is good, all are told. */
static void test_owsctl_reads_a_recorded_image(void)
{
	const char *runner = getenv("RUNNER");
	char command[512];

	snprintf(
		command, sizeof(command),
		"for n in bool byte short long word dword float room.temperature large label empty;"
		" do %s %s/../owsctl -n %s get $n; done 2>/dev/null; true",
		runner ? runner : "", here, instance);
	TEST_ASSERT_EQUAL_STRING("1\n255\n-32768\n-2147483648\n65535\n4294967295\n45.5\n-21.0625\n"
	                         "-9223372036854775808\n" LONG_TEXT "\n\n",
	                         output_of(command));
}

int main(int argc, char **argv)
{
	/* owsctl lies beside the folder of this program */
	snprintf(here, sizeof(here), "%s", argv[0]);
	if (strrchr(here, '/'))
		*strrchr(here, '/') = '\0';
	if (argc == 2 && strcmp(argv[1], "record") == 0) {
		record();
		return 0;
	}
	UNITY_BEGIN();
	RUN_TEST(test_libows_reads_a_recorded_image);
	RUN_TEST(test_python_reads_a_recorded_image);
	RUN_TEST(test_owsctl_reads_a_recorded_image);
	RUN_TEST(test_a_recorded_segment_can_be_commanded);
	RUN_TEST(test_what_was_commanded_is_carried_from_a_recorded_segment);
	RUN_TEST(test_todays_writer_lays_the_same_out_in_the_same_way);
	return UNITY_END();
}
