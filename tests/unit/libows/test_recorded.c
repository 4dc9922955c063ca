/* SPDX-License-Identifier: MIT */
/*
 * An image recorded from an earlier owsd, read by today's libows, ows.py and owsctl, value by
 * value; the segments of the major version before, which they refuse. Runs python3 and owsctl in
 * the directory of the sources. `test_recorded record` writes the recording again: only for a new
 * file.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

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

/*
 * What readers in other languages rely on: not one byte elsewhere, as long as this is the layout.
 */
static void test_todays_writer_lays_the_same_out_in_the_same_way(void)
{
	char recorded[SIZE_MAX_];
	uint32_t size = read_recording(RECORDED, recorded);

	if (((const struct ows_image_header *)(const void *)recorded)->minor != OWS_LAYOUT_MINOR)
		TEST_IGNORE_MESSAGE("the recording is of an earlier minor version");
	make_image();
	TEST_ASSERT_EQUAL(size, image.header->size);
	TEST_ASSERT_EQUAL_MEMORY(recorded, image_memory, size);
}

static void test_in_an_image_of_an_earlier_minor_version_a_signal_is_its_path(void)
{
	static _Alignas(8) char recorded[SIZE_MAX_];
	const struct ows_area_entry *infos;
	uint32_t size = read_recording(RECORDED, recorded);
	struct ows_info info;
	struct ows *h;

	infos = (const struct ows_area_entry *)(const void *)(recorded + 256) + OWS_AREA_INFOS - 1;
	for (uint32_t i = 0; i < infos->count; i++)
		((struct ows_info_entry *)(void *)(recorded + infos->off))[i].identity_off = 0;
	show("image", recorded, size);
	TEST_ASSERT_EQUAL(0, ows_open(instance, OWS_READ, &h));
	TEST_ASSERT_EQUAL(0, ows_info(h, DOUBLE_ - 1, &info));
	TEST_ASSERT_EQUAL_STRING("/28.000000000001/temperature", info.identity);
	ows_close(h);
}

static void test_todays_readers_refuse_the_layout_of_another_major_version(void)
{
	static _Alignas(8) char recorded[SIZE_MAX_];
	char command[512];
	const char *runner = getenv("RUNNER");
	uint32_t size = read_recording(RECORDED, recorded);
	struct ows *h;

	((struct ows_image_header *)(void *)recorded)->major++;
	show("image", recorded, size);
	TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_READ, &h));
	TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_CONTROL, &h));
	TEST_ASSERT_EQUAL_STRING("71\n", python("try: ows.Ows(sys.argv[1])\n"
	                                        "except OSError as e: print(e.errno)\n"));
	snprintf(command, sizeof(command), "%s %s/../owsctl -n %s get bool 2>&1; true",
	         runner ? runner : "", here, instance);
	TEST_ASSERT_NOT_NULL(strstr(output_of(command), "version"));
}

static void test_python_reads_a_recorded_image(void)
{
	TEST_ASSERT_EQUAL_STRING(
		"bool|True|192|1|1.0|101|0|0|1|1009000000000|1009500000000\n"
		"byte|255|192|2|2.0|102|0|0|0|1008000000000|1009000000000\n"
		"short|-32768|12|3|3.0|103|0|-5|1|1007000000000|1008500000000\n"
		"long|-2147483648|20|0|4.0|104|0|0|0|1006000000000|1008000000000\n"
		"word|65535|86|1|5.0|105|0|0|1|1005000000000|1007500000000\n"
		"dword|4294967295|192|2|6.0|106|0|0|0|1004000000000|1007000000000\n"
		"float|45.5|192|3|7.0|107|0|0|1|1003000000000|1006500000000\n"
		"room.temperature|-21.0625|192|0|8.0|108|0|0|0|1002000000000|1006000000000\n"
		"large|-9223372036854775808|192|1|9.0|109|0|0|1|1001000000000|1005500000000\n"
		"label|" LONG_TEXT "|192|2|10.0|110|0|0|0|1000000000000|1005000000000\n"
		"empty||192|3|11.0|111|0|0|1|999000000000|1004500000000\n"
		"never|False|0|0|10.0|0|0|0|0|0|0\n",
		python("s = ows.Ows(sys.argv[1])\n"
	               "for n in s.names():\n"
	               "    v = s.get(n, 1010 * 10**9)\n"
	               "    print(n, v.value, v.quality, v.detail, v.age, v.count, v.applied, v.err,"
	               " v.target, v.measured_ns, v.tried_ns, sep=\"|\")\n"));
	TEST_ASSERT_EQUAL_STRING(
		"5000000002 0.5 2.0 200.0 2 3 10 402 10 True False 77 3\n"
		"0 localhost:4304 suspended 4 0 0 None\n"
		"1 i2c:/dev/i2c-1 up 5 0 6 None\n"
		"0 never 1001000000000 False True device raised 192 1,0,0,1 0\n"
		"1 room.temperature 1002000000000 30.5 None high high acknowledged 192  0\n"
		"0 byte 1002000000000 255 set 192 4 3 1000 777 hmi Jana\n"
		"0 False False True returned to normal unacknowledged high high None\n"
		"1003000000000 2003000000000 sensor is being moved Jana\n"
		"Info(name=\"long\", path=\"/1D.000000000001/a\", type=4, output=False, fresh=True,"
		" alarm=False, per_factor=4, stale_after_ns=2000000000, unit=None,"
		" description=None, family=None, device=None, calibrated=None, points=None,"
		" decimals=None, scale=1.0, offset=0.0, min=None, max=None, limit_hh=None,"
		" limit_h=None, limit_l=None, limit_ll=None, filter=0.0, deadband=0.0, confirm=False,"
		" identity=\"/1D.000000000001/a\", group=None)\n",
		python("s = ows.Ows(sys.argv[1])\nN = 1010 * 10**9\n"
	               "print(*(s.get(\"byte_\" + a, N).value for a in (\"TRANSACTIONS\", \"Period\", \"Age\","
	               " \"AgeMax\", \"PerCount\", \"PerMax\", \"PendCount\", \"PendLast\", \"PendMax\","
	               " \"ReadEnable\", \"WE\")), s.get(\"_TRANSACTIONS\", N).value,"
	               " s.get(\"_RECONNECTS\", N).value)\n"
	               "for t in s.targets(): print(*t)\n"
	               "for a in s.alarms(): print(*a[:-1], a.who.serial)\n"
	               "for c in s.commands(): print(*c[:-1], *c.who)\n"
	               "a = s.alarm_state(\"room.temperature\")\nprint(*a[:-1])\n"
	               "print(a.shelf.since_ns, a.shelf.until_ns, a.shelf.why, a.shelf.who.person)\n"
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
	RUN_TEST(test_in_an_image_of_an_earlier_minor_version_a_signal_is_its_path);
	RUN_TEST(test_todays_readers_refuse_the_layout_of_another_major_version);
	RUN_TEST(test_python_reads_a_recorded_image);
	RUN_TEST(test_owsctl_reads_a_recorded_image);
	RUN_TEST(test_todays_writer_lays_the_same_out_in_the_same_way);
	return UNITY_END();
}
