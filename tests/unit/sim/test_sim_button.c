/* SPDX-License-Identifier: MIT */
/* Tests of the buttons of the simulator: faults on demand as properties of the target. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "unity.h"

#include "hal/sim/button.h"
#include "hal/sim/scenario.h"
#include "tests/unit/aid/host.h"

#define CHIP "chip DS2482-100 0x18\n"
#define ROOM CHIP "DS18B20 28.000000000001 as room temperature 21\n"
#define READ_ROOM "/28.000000000001/temperature"

static struct sim_net net;
static struct host host;
static struct bus *bus;
static char why[200], data[200];
static uint32_t ids;

void setUp(void)
{
	why[0] = '\0';
	bus = NULL;
}

void tearDown(void)
{
	sim_net_clear(&net);
	bus_destroy(bus);
}

static void refuses(const char *text, const char *expected)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL,
	                              sim_scenario_parse("s", text, &net, why, sizeof(why)), text);
	why[strlen(expected)] = '\0';
	TEST_ASSERT_EQUAL_STRING(expected, why);
}

static void test_a_wrong_button_is_named_with_its_column(void)
{
	char many[2000] = CHIP;

	refuses(CHIP "button", "s:2:7: \"\": expected a name: a letter, then letters, digits");
	refuses(CHIP "button 2 short 0x18", "s:2:8: \"2\": expected a name");
	refuses(CHIP "button a/b short 0x18", "s:2:8: \"a/b\": expected a name");
	refuses(CHIP "button a.b short 0x18", "s:2:8: \"a.b\": expected a name");
	refuses(CHIP "button a2345678901234567890123456789012 short 0x18",
	        "s:2:8: \"a2345678901234567890123456789012\": expected a name");
	refuses(CHIP "button b short 0x18\nbutton b short 0x18",
	        "s:3:8: there is a button \"b\" already");
	refuses(CHIP "button b", "s:2:9: \"\": expected set, unplug");
	refuses(CHIP "button b burn 0x18", "s:2:10: \"burn\": expected set, unplug");
	refuses(CHIP "button b short 0x19", "s:2:16: \"0x19\": expected the address of a chip");
	refuses(CHIP "button b unplug room", "s:2:17: there is no device \"room\"");
	refuses(CHIP "button b short 0x18 for 5s", "s:2:8: a button has unplug, corrupt or short");
	refuses(CHIP "button b end short 0x18", "s:2:8: a button has unplug, corrupt or short");
	refuses(CHIP "button b jam 0x18", "s:2:8: a button has unplug, corrupt or short");
	refuses(CHIP "button b remove adapter", "s:2:8: a button has unplug, corrupt or short");
	refuses(ROOM "button b plug room", "s:3:8: a button has unplug, corrupt or short");
	refuses(ROOM "button b set room temperature 5", "s:3:8: a button has unplug, corrupt or");
	refuses("button b short 0x18", "s:1:16: \"0x18\": expected the address of a chip");
	for (int i = 0; i <= SIM_MAX_BUTTONS; i++)
		snprintf(many + strlen(many), 40, "button b%d short 0x18\n", i);
	refuses(many, "s:18:8: there are 16 buttons already");
}

/* A target on this text, and its first search is over. */
static void target(const char *text)
{
	int fd = memfd_create("scenario", MFD_CLOEXEC);
	char name[40];

	TEST_ASSERT_TRUE(fd >= 0);
	TEST_ASSERT_EQUAL((ssize_t)strlen(text), write(fd, text, strlen(text)));
	snprintf(name, sizeof(name), "sim:/proc/self/fd/%d", fd);
	host_init_virtual(&host);
	bus = host_bus(&host, name);
	close(fd);
	host_run(&host, bus, host_now(&host) + 5 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_UP));
}

/* The answer to a request, which comes within so many milliseconds. */
static struct bus_answer ask_within(int64_t ms, enum bus_op op, const char *path, const char *text)
{
	struct bus_req req = {.id = ++ids,
	                      .op = (uint8_t)op,
	                      .prio = op == BUS_WRITE ? BUS_OUTPUT : BUS_INPUT,
	                      .fresh = true,
	                      .deadline_ns = host_now(&host) + ms * HOST_MS,
	                      .path = path,
	                      .data = (uint8_t *)data,
	                      .len = op == BUS_WRITE ? (uint32_t)strlen(text) : sizeof(data)};
	const struct bus_answer *answer;

	memset(data, 0, sizeof(data));
	if (op == BUS_WRITE)
		memcpy(data, text, req.len);
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	host_run_answers(&host, bus, host.answers + 1, req.deadline_ns + HOST_MS);
	answer = host_answer(&host, req.id);
	TEST_ASSERT_NOT_NULL_MESSAGE(answer, path);
	return *answer;
}

static int ask(enum bus_op op, const char *path)
{
	return ask_within(3000, op, path, "").err;
}

static void set(const char *path, const char *text)
{
	TEST_ASSERT_EQUAL_INT(0, ask_within(20, BUS_WRITE, path, text).err);
}

static void is(const char *path, int number)
{
	struct bus_answer answer = ask_within(20, BUS_READ, path, "");

	TEST_ASSERT_EQUAL_INT(0, answer.err);
	TEST_ASSERT_EQUAL_INT(BUS_NUMBER, answer.kind);
	TEST_ASSERT_EQUAL_INT(number, (int)answer.number);
	TEST_ASSERT_EQUAL_STRING(number ? "1" : "0", data);
	TEST_ASSERT_TRUE(answer.detail & BUS_DETAIL_SIMULATED);
}

static void test_a_button_pulls_a_device_off_and_puts_it_back(void)
{
	target(ROOM "button off unplug room\n");
	is("/simulator/off", 0);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_READ, READ_ROOM));
	set("/simulator/off", "1");
	is("/simulator/off", 1);
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_READ, READ_ROOM));
	set("simulator/off", "0\n");
	is("/uncached/simulator/off", 0);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_READ, READ_ROOM));
}

static void test_a_button_is_read_and_written_while_the_wire_is_short(void)
{
	target(ROOM "button s short 0x18\n");
	set("/simulator/s", "1");
	for (int i = 0; i < 20; i++) {
		TEST_ASSERT_EQUAL_INT(-ECOMM, ask(BUS_READ, READ_ROOM));
		is("/simulator/s", 1);
		set("/simulator/s", "1");
	}
	set("/simulator/s", "0");
	is("/simulator/s", 0);
	host_run(&host, bus, host_now(&host) + 5 * HOST_S);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_READ, READ_ROOM));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
}

static void test_a_button_is_written_while_the_chip_is_stuck(void)
{
	target(ROOM "button off unplug room\nat 6s every 1s stick 0x18\n");
	for (int i = 0; i < 10; i++) {
		host_run(&host, bus, host_now(&host) + HOST_S);
		set("/simulator/off", i & 1 ? "1" : "0");
		is("/simulator/off", i & 1);
	}
}

static void test_a_button_disturbs_the_answers_of_a_device(void)
{
	target(ROOM "button noise corrupt room\n");
	set("/simulator/noise", "1");
	is("/simulator/noise", 1);
	TEST_ASSERT_EQUAL_INT(-EBADMSG, ask(BUS_READ, READ_ROOM));
	set("/simulator/noise", "0");
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_READ, READ_ROOM));
	is("/simulator/noise", 0);
}

static void test_a_button_shows_and_ends_what_the_time_table_began(void)
{
	target(ROOM "button s short 0x18\nat 10s short 0x18 for 10s\nat 40s short 0x18\n");
	is("/simulator/s", 0);
	host_run(&host, bus, host_now(&host) + 7 * HOST_S);
	is("/simulator/s", 1);
	host_run(&host, bus, host_now(&host) + 10 * HOST_S);
	is("/simulator/s", 0);
	host_run(&host, bus, host_now(&host) + 20 * HOST_S);
	is("/simulator/s", 1);
	set("/simulator/s", "0");
	host_run(&host, bus, host_now(&host) + 5 * HOST_S);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_READ, READ_ROOM));
}

static void test_the_buttons_are_a_directory_of_the_target(void)
{
	static const char list[] = "/simulator/off\n/simulator/s\n";
	struct bus_answer answer;

	target(ROOM "button off unplug room\nbutton s short 0x18\n");
	answer = ask_within(20, BUS_DIR, "/simulator", "");
	TEST_ASSERT_EQUAL_INT(0, answer.err);
	TEST_ASSERT_EQUAL_UINT(strlen(list), answer.len);
	TEST_ASSERT_EQUAL_STRING(list, data);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_PROBE, "/simulator"));
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_PROBE, "/simulator/s"));
	TEST_ASSERT_EQUAL_INT(-ENOTDIR, ask(BUS_DIR, "/simulator/s"));
	TEST_ASSERT_EQUAL_INT(-EISDIR, ask(BUS_READ, "/simulator"));
	TEST_ASSERT_EQUAL_INT(-ENOENT, ask(BUS_READ, "/simulator/none"));
	TEST_ASSERT_EQUAL_INT(-ENOENT, ask(BUS_READ, "/simulator/s/s"));
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_READ, "/bus.0/simulator/s"));
}

static void test_what_is_neither_0_nor_1_is_refused_and_changes_nothing(void)
{
	static const char *const wrong[] = {"", " ", "2", "01", "yep", "1 0", "\x01"};

	target(ROOM "button s short 0x18\n");
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			-EINVAL, ask_within(20, BUS_WRITE, "/simulator/s", wrong[i]).err, wrong[i]);
	is("/simulator/s", 0);
}

static void test_a_directory_that_does_not_fit_is_refused(void)
{
	uint8_t room[20];
	struct bus_req req = {
		.op = BUS_DIR, .path = "/simulator", .data = room, .len = sizeof(room)};
	struct bus_answer answer = {0};

	TEST_ASSERT_EQUAL_INT(
		0, sim_scenario_parse("s", CHIP "button first short 0x18\nbutton next short 0x18\n",
	                              &net, why, sizeof(why)));
	TEST_ASSERT_TRUE(button_answer(&net, &req, 0, &answer));
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, answer.err);
}

static void test_a_file_without_buttons_has_no_such_directory(void)
{
	target(ROOM);
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_DIR, "/simulator"));
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_READ, "/simulator/short"));
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_WRITE, "/simulator/short"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_wrong_button_is_named_with_its_column);
	RUN_TEST(test_a_button_pulls_a_device_off_and_puts_it_back);
	RUN_TEST(test_a_button_is_read_and_written_while_the_wire_is_short);
	RUN_TEST(test_a_button_is_written_while_the_chip_is_stuck);
	RUN_TEST(test_a_button_disturbs_the_answers_of_a_device);
	RUN_TEST(test_a_button_shows_and_ends_what_the_time_table_began);
	RUN_TEST(test_the_buttons_are_a_directory_of_the_target);
	RUN_TEST(test_what_is_neither_0_nor_1_is_refused_and_changes_nothing);
	RUN_TEST(test_a_directory_that_does_not_fit_is_refused);
	RUN_TEST(test_a_file_without_buttons_has_no_such_directory);
	return UNITY_END();
}
