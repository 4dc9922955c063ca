/* SPDX-License-Identifier: MIT */
/* The bus "gpio" over a chip that is played. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/bus/backends.h"
#include "hal/gpio/api.h"
#include "tests/unit/aid/fake_gpio.h"
#include "tests/unit/aid/one_bus.h"

static uint8_t data[256];
static char why[200];

void setUp(void)
{
	fake_gpio_begin();
	host_init_virtual(&host);
	host.now = 100 * HOST_S;
}

void tearDown(void)
{
	one_bus_end();
	fake_gpio_end();
}

static void start(void)
{
	if (!bus)
		bus = host_bus(&host, "gpio:gpiochip0");
	bus_step(bus, host.now);
}

static const struct bus_answer *ask(enum bus_op op, enum bus_prio prio, const char *path,
                                    const char *text)
{
	static uint32_t id;
	struct bus_req req = {.id = ++id,
	                      .op = (uint8_t)op,
	                      .prio = (uint8_t)prio,
	                      .path = path,
	                      .data = data,
	                      .len = text ? (uint32_t)strlen(text) : sizeof(data),
	                      .deadline_ns = INT64_MAX};

	memset(data, 0, sizeof(data));
	if (text)
		memcpy(data, text, strlen(text));
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	bus_step(bus, host.now);
	TEST_ASSERT_EQUAL_UINT(1, host_answers(&host, id));
	return host_answer(&host, id);
}

static const struct bus_answer *input(const char *path)
{
	return ask(BUS_READ, BUS_INPUT, path, NULL);
}

static int output(const char *path, const char *text)
{
	return ask(BUS_WRITE, BUS_OUTPUT, path, text)->err;
}

/* It was read as text at that time. */
static void expect(const char *path, const char *text, int64_t at_ns)
{
	const struct bus_answer *answer = input(path);

	TEST_ASSERT_EQUAL_INT(0, answer->err);
	TEST_ASSERT_EQUAL_UINT32(strlen(text), answer->len);
	TEST_ASSERT_EQUAL_MEMORY(text, data, strlen(text));
	TEST_ASSERT_EQUAL_UINT8(BUS_NUMBER, answer->kind);
	TEST_ASSERT_TRUE(answer->number == (text[0] == '1'));
	TEST_ASSERT_EQUAL_INT64(at_ns, answer->measured_ns);
}

static void test_a_level_that_stands_is_as_new_as_its_reading(void)
{
	fake_gpio.line[3].high = true;
	start();
	expect("/gpio/3", "1", host.now);
	host.now += HOST_S;
	expect("/gpio/3", "1", host.now);
	TEST_ASSERT_EQUAL_UINT(1, fake_gpio.line[3].requests);
	TEST_ASSERT_EQUAL_UINT8(GPIO_INPUT, fake_gpio.line[3].setup.direction);
}

static void test_a_change_has_the_time_of_its_edge(void)
{
	int64_t at = host.now + 30 * HOST_MS;

	start();
	expect("/gpio/3", "0", host.now);
	fake_gpio_level(3, true, at);
	host.now += 100 * HOST_MS;
	expect("/gpio/3", "1", at);
	host.now += 100 * HOST_MS;
	expect("/gpio/3", "1", host.now);
}

static void test_a_pulse_between_two_readings_is_shown_by_the_first_and_over_in_the_second(void)
{
	int64_t on = host.now + 30 * HOST_MS, off = on + HOST_MS;

	start();
	expect("/gpio/3", "0", host.now);
	fake_gpio_level(3, true, on);
	fake_gpio_level(3, false, off);
	host.now += 100 * HOST_MS;
	expect("/gpio/3", "1", on);
	host.now += 100 * HOST_MS;
	expect("/gpio/3", "0", off);
	host.now += 100 * HOST_MS;
	expect("/gpio/3", "0", host.now);
}

static void test_edges_that_no_reading_shows_are_counted(void)
{
	start();
	expect("/gpio/3", "0", host.now);
	for (unsigned i = 0; i < 5; i++)
		fake_gpio_level(3, i % 2 == 0, host.now + (i + 1) * HOST_MS);
	host.now += 100 * HOST_MS;
	expect("/gpio/3", "1", host.now - 95 * HOST_MS);
	TEST_ASSERT_EQUAL_UINT64(5, counted("edges"));
	TEST_ASSERT_EQUAL_UINT64(4, counted("edges_unseen"));
	TEST_ASSERT_EQUAL_UINT64(0, counted("pulses"));
}

static void test_where_the_kernel_lost_edges_the_level_counts_and_no_time_is_made_up(void)
{
	start();
	expect("/gpio/3", "0", host.now);
	for (unsigned i = 0; i < GPIO_EDGES_KEPT + 5; i++)
		fake_gpio_level(3, i % 2 == 0, host.now + (i + 1) * HOST_MS);
	host.now += 100 * HOST_MS;
	expect("/gpio/3", "1", host.now);
}

static void test_an_output_is_driven_once_requested_and_then_set(void)
{
	start();
	TEST_ASSERT_EQUAL_INT(0, output("/gpio/5", "1"));
	TEST_ASSERT_TRUE(fake_gpio.line[5].high);
	TEST_ASSERT_EQUAL_UINT(0, fake_gpio.line[5].sets);
	TEST_ASSERT_EQUAL_INT(0, output("/gpio/5", "0"));
	TEST_ASSERT_FALSE(fake_gpio.line[5].high);
	TEST_ASSERT_EQUAL_UINT(1, fake_gpio.line[5].sets);
	TEST_ASSERT_EQUAL_UINT(1, fake_gpio.line[5].requests);
	expect("/gpio/5", "0", host.now);
	TEST_ASSERT_EQUAL_INT(-EINVAL, output("/gpio/5", "2"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, output("/gpio/5", ""));
	TEST_ASSERT_EQUAL_INT(0, output("/gpio/5", " on\n"));
	TEST_ASSERT_TRUE(fake_gpio.line[5].high);
}

static void test_options_give_lines_their_sense_bias_and_drive(void)
{
	strcpy(fake_gpio.line[6].name, "DOOR");
	bus = host_bus(&host, "gpio:gpiochip0");
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "ActiveLow", "5, DOOR", why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "PullUp", "DOOR", why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "OpenDrain", "5", why, sizeof(why)));
	start();
	expect("/gpio/DOOR", "1", host.now);
	TEST_ASSERT_EQUAL_UINT8(GPIO_PULL_UP, fake_gpio.line[6].setup.bias);
	TEST_ASSERT_EQUAL_INT(0, output("/gpio/5", "1"));
	TEST_ASSERT_FALSE(fake_gpio.line[5].high);
	TEST_ASSERT_EQUAL_UINT8(GPIO_OPEN_DRAIN, fake_gpio.line[5].setup.drive);
	TEST_ASSERT_EQUAL_UINT8(GPIO_BIAS_AS_IT_IS, fake_gpio.line[5].setup.bias);
	expect("/gpio/4", "0", host.now);
	TEST_ASSERT_FALSE(fake_gpio.line[4].setup.active_low);
}

static void test_options_that_cannot_be_are_refused_with_a_reason(void)
{
	bus = host_bus(&host, "gpio:gpiochip0");
	TEST_ASSERT_EQUAL_INT(-ENOENT, bus_option(bus, "PowerLine", "x/1", why, sizeof(why)));
	TEST_ASSERT_EQUAL_STRING("a target of scheme gpio has no option PowerLine", why);
	TEST_ASSERT_EQUAL_INT(-EINVAL, bus_option(bus, "PullUp", " , ", why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "PullUp", "3,NOWHERE", why, sizeof(why)));
	start();
	TEST_ASSERT_EQUAL_UINT(1, host.events);
	TEST_ASSERT_EQUAL_UINT8(BUS_DOWN, host.event[0].news);
	TEST_ASSERT_EQUAL_STRING("PullUp: gpiochip0 has no line NOWHERE; gpioinfo lists them",
	                         host.event[0].text);
}

static void test_a_line_with_two_pulls_is_refused(void)
{
	strcpy(fake_gpio.line[6].name, "DOOR");
	bus = host_bus(&host, "gpio:gpiochip0");
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "PullUp", "5, DOOR", why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "OpenDrain", "DOOR", why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "PullDown", "4, 6", why, sizeof(why)));
	start();
	TEST_ASSERT_EQUAL_UINT8(BUS_DOWN, host.event[0].news);
	TEST_ASSERT_EQUAL_STRING(
		"PullDown: line 6 of gpiochip0 has another pull or drive: name it once",
		host.event[0].text);
}

static void test_lines_are_listed_and_probed(void)
{
	start();
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_DIR, BUS_GUEST, "/", NULL)->err);
	TEST_ASSERT_EQUAL_STRING("/gpio\n", data);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_DIR, BUS_GUEST, "/gpio", NULL)->err);
	TEST_ASSERT_EQUAL_STRING("/gpio/0\n/gpio/1\n/gpio/2\n/gpio/3\n/gpio/4\n/gpio/5\n/gpio/6\n"
	                         "/gpio/7\n",
	                         data);
	TEST_ASSERT_EQUAL_INT(-ENOTDIR, ask(BUS_DIR, BUS_GUEST, "/gpio/3", NULL)->err);
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, ask(BUS_DIR, BUS_ALARM, "/alarm", NULL)->err);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_PROBE, BUS_INPUT, "/gpio", NULL)->err);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_PROBE, BUS_INPUT, "/gpiochip0/3", NULL)->err);
	TEST_ASSERT_EQUAL_INT(-ENOENT, ask(BUS_PROBE, BUS_INPUT, "/gpio/8", NULL)->err);
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_PROBE, BUS_INPUT, "/28.000000000001", NULL)->err);
	TEST_ASSERT_EQUAL_INT(-EISDIR, input("/gpio")->err);
	TEST_ASSERT_EQUAL_INT(-ENOENT, input("/gpio/3/level")->err);
}

static void test_a_guest_looks_and_changes_nothing(void)
{
	const struct bus_answer *answer;

	fake_gpio.line[2].high = true;
	start();
	answer = ask(BUS_READ, BUS_GUEST, "/gpio/2", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer->err);
	TEST_ASSERT_EQUAL_UINT8('1', data[0]);
	TEST_ASSERT_EQUAL_UINT8(GPIO_AS_IT_IS, fake_gpio.line[2].setup.direction);
	TEST_ASSERT_FALSE(fake_gpio.line[2].held);
	TEST_ASSERT_EQUAL_INT(-EACCES, ask(BUS_WRITE, BUS_GUEST, "/gpio/2", "0")->err);
	TEST_ASSERT_TRUE(fake_gpio.line[2].high);
	TEST_ASSERT_EQUAL_INT(0, output("/gpio/2", "1"));
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_WRITE, BUS_GUEST, "/gpio/2", "0")->err);
	TEST_ASSERT_FALSE(fake_gpio.line[2].high);
}

static void test_a_guest_takes_no_edge_away(void)
{
	int64_t at = host.now + HOST_MS;

	start();
	expect("/gpio/3", "0", host.now);
	fake_gpio_level(3, true, at);
	host.now += 10 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_READ, BUS_GUEST, "/gpio/3", NULL)->err);
	TEST_ASSERT_EQUAL_UINT8('1', data[0]);
	expect("/gpio/3", "1", at);
}

static void test_who_has_a_line_is_told_once_and_it_is_taken_when_it_is_free(void)
{
	strcpy(fake_gpio.line[4].consumer, "onewire@4");
	start();
	TEST_ASSERT_EQUAL_INT(-EBUSY, input("/gpio/4")->err);
	TEST_ASSERT_EQUAL_INT(-EBUSY, output("/gpio/4", "1"));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_NOTE));
	TEST_ASSERT_EQUAL_STRING("line 4 of fake is in use by \"onewire@4\"",
	                         host.event[host.events - 1].text);
	TEST_ASSERT_EQUAL_UINT64(2, counted("lines_refused"));
	fake_gpio.line[4].consumer[0] = '\0';
	expect("/gpio/4", "0", host.now);
}

static void test_a_missing_chip_is_told_once_and_served_when_it_comes(void)
{
	fake_gpio.open_err = -ENOENT;
	start();
	host_run(&host, bus, host.now + 5 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host.events);
	TEST_ASSERT_EQUAL_UINT8(BUS_DOWN, host.event[0].news);
	TEST_ASSERT_EQUAL_INT(-ENODEV, host.event[0].err);
	TEST_ASSERT_EQUAL_STRING("no /dev/gpiochip0: gpiodetect lists the chips there are",
	                         host.event[0].text);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, input("/gpio/3")->err);
	fake_gpio.open_err = 0;
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_UP));
	TEST_ASSERT_EQUAL_INT(0, input("/gpio/3")->err);
}

static void test_a_file_that_is_no_chip_is_told_from_none(void)
{
	TEST_ASSERT_EQUAL_INT(-ENOTTY, gpio_open_error("/dev/null", -ENODEV));
	TEST_ASSERT_EQUAL_INT(-ENOTTY, gpio_open_error("/dev/null", -ENOENT));
	TEST_ASSERT_EQUAL_INT(-EACCES, gpio_open_error("/dev/null", -EACCES));
	TEST_ASSERT_EQUAL_INT(-ENOENT, gpio_open_error("/dev/there-is-none", -ENOENT));
	TEST_ASSERT_EQUAL_INT(-ENODEV, gpio_open_error("/dev/there-is-none", -ENODEV));
}

static void test_without_the_right_the_group_is_named(void)
{
	fake_gpio.open_err = -EACCES;
	start();
	TEST_ASSERT_EQUAL_INT(-EACCES, host.event[0].err);
	TEST_ASSERT_NOT_NULL(strstr(host.event[0].text, "group that owns it (gpio)"));
}

/* Of a service with DeviceAllow=, whoever owns the file; not one word is cut off. */
static void test_where_a_filter_refuses_it_no_group_is_named(void)
{
	fake_gpio.open_err = -EPERM;
	start();
	TEST_ASSERT_EQUAL_INT(-EACCES, host.event[0].err);
	TEST_ASSERT_EQUAL_STRING("/dev/gpiochip0: a device filter refuses it (DeviceAllow= of the "
	                         "service, devices of the container): restart owsd, or allow it "
	                         "there",
	                         host.event[0].text);
}

static void test_a_chip_that_goes_takes_the_target_down_and_back(void)
{
	start();
	TEST_ASSERT_EQUAL_INT(0, output("/gpio/5", "1"));
	fake_gpio.gone = true;
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, output("/gpio/5", "0"));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, output("/gpio/5", "0"));
	fake_gpio.gone = false;
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_UP));
	TEST_ASSERT_EQUAL_INT(0, output("/gpio/5", "0"));
	TEST_ASSERT_FALSE(fake_gpio.line[5].high);
}

static void test_a_chip_that_goes_is_noticed_without_a_request(void)
{
	start();
	expect("/gpio/0", "0", host.now);
	fake_gpio.gone = true;
	host_run(&host, bus, host.now + 6 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_DOWN));
}

/* The error of the last BUS_DOWN of so many. */
static int down_of(unsigned count)
{
	int err = 0;

	TEST_ASSERT_EQUAL_UINT(count, host_events(&host, BUS_DOWN));
	for (unsigned i = 0; i < host.events; i++)
		if (host.event[i].news == BUS_DOWN)
			err = host.event[i].err;
	return err;
}

static void test_a_chip_that_is_back_and_cannot_be_opened_is_not_called_gone(void)
{
	start();
	fake_gpio.gone = true;
	fake_gpio.open_err = -ENODEV;
	host_run(&host, bus, host.now + 6 * HOST_S);
	TEST_ASSERT_EQUAL_INT(-ENODEV, down_of(1));
	fake_gpio.gone = false;
	fake_gpio.open_err = -EACCES;
	host_run(&host, bus, host.now + 6 * HOST_S);
	TEST_ASSERT_EQUAL_INT(-EACCES, down_of(2));
	fake_gpio.open_err = 0;
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_UP));
	fake_gpio.gone = true;
	fake_gpio.open_err = -ENODEV;
	host_run(&host, bus, host.now + 6 * HOST_S);
	TEST_ASSERT_EQUAL_INT(-ENODEV, down_of(3));
}

static void test_a_chip_that_cannot_be_opened_after_a_pause_says_so_again(void)
{
	fake_gpio.open_err = -EACCES;
	start();
	TEST_ASSERT_EQUAL_INT(-EACCES, down_of(1));
	bus_suspend(bus, true);
	bus_suspend(bus, false);
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_INT(-EACCES, down_of(2));
}

static void test_suspended_it_holds_nothing(void)
{
	start();
	expect("/gpio/1", "0", host.now);
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_UINT(0, fake_gpio.open);
	TEST_ASSERT_FALSE(fake_gpio.line[1].held);
	bus_suspend(bus, false);
	host_run(&host, bus, host.now + HOST_S);
	expect("/gpio/1", "0", host.now);
}

static void test_a_chip_is_named_or_refused(void)
{
	TEST_ASSERT_EQUAL_INT(-EINVAL, bus_create("gpio:", &host.env, &bus, why, sizeof(why)));
	TEST_ASSERT_EQUAL_STRING("expected a GPIO chip, as gpio:gpiochip0", why);
	TEST_ASSERT_EQUAL_INT(-EINVAL, bus_create("gpio", &host.env, &bus, why, sizeof(why)));
	gpio_substitute = NULL;
	if (!gpio_library) {
		TEST_ASSERT_EQUAL_INT(
			-EINVAL, bus_create("gpio:gpiochip0", &host.env, &bus, why, sizeof(why)));
		TEST_ASSERT_EQUAL_STRING("this owsd was built without libgpiod", why);
	}
	bus = NULL;
}

static void test_a_line_is_written_as_chip_and_line_with_words_behind(void)
{
	static const struct {
		const char *text, *chip, *line;
		uint8_t bias, drive;
		bool active_low;
	} good[] = {
		{"gpiochip0/22", "gpiochip0", "22", 0, 0, false},
		{"/dev/gpiochip1/LED,active-low", "/dev/gpiochip1", "LED", 0, 0, true},
		{"pinctrl-bcm2711/5,pull-up,open-drain", "pinctrl-bcm2711", "5", GPIO_PULL_UP,
	         GPIO_OPEN_DRAIN, false},
	};
	static const char *const bad[] = {"",
	                                  "22",
	                                  "gpiochip0/",
	                                  "/22",
	                                  "gpiochip0/22,",
	                                  "gpiochip0/22,activelow",
	                                  "g/1,pull-up,pull-down"};
	struct gpio_spec spec;

	for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++) {
		TEST_ASSERT_EQUAL_INT(0, gpio_spec_parse(good[i].text, &spec, why, sizeof(why)));
		TEST_ASSERT_EQUAL_STRING(good[i].chip, spec.chip);
		TEST_ASSERT_EQUAL_STRING(good[i].line, spec.line);
		TEST_ASSERT_EQUAL_UINT8(good[i].bias, spec.setup.bias);
		TEST_ASSERT_EQUAL_UINT8(good[i].drive, spec.setup.drive);
		TEST_ASSERT_EQUAL(good[i].active_low, spec.setup.active_low);
	}
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		why[0] = '\0';
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			-EINVAL, gpio_spec_parse(bad[i], &spec, why, sizeof(why)), bad[i]);
		TEST_ASSERT_NOT_EQUAL_CHAR('\0', why[0]);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_level_that_stands_is_as_new_as_its_reading);
	RUN_TEST(test_a_change_has_the_time_of_its_edge);
	RUN_TEST(test_a_pulse_between_two_readings_is_shown_by_the_first_and_over_in_the_second);
	RUN_TEST(test_edges_that_no_reading_shows_are_counted);
	RUN_TEST(test_where_the_kernel_lost_edges_the_level_counts_and_no_time_is_made_up);
	RUN_TEST(test_an_output_is_driven_once_requested_and_then_set);
	RUN_TEST(test_options_give_lines_their_sense_bias_and_drive);
	RUN_TEST(test_options_that_cannot_be_are_refused_with_a_reason);
	RUN_TEST(test_a_line_with_two_pulls_is_refused);
	RUN_TEST(test_lines_are_listed_and_probed);
	RUN_TEST(test_a_guest_looks_and_changes_nothing);
	RUN_TEST(test_a_guest_takes_no_edge_away);
	RUN_TEST(test_who_has_a_line_is_told_once_and_it_is_taken_when_it_is_free);
	RUN_TEST(test_a_missing_chip_is_told_once_and_served_when_it_comes);
	RUN_TEST(test_a_file_that_is_no_chip_is_told_from_none);
	RUN_TEST(test_without_the_right_the_group_is_named);
	RUN_TEST(test_where_a_filter_refuses_it_no_group_is_named);
	RUN_TEST(test_a_chip_that_goes_takes_the_target_down_and_back);
	RUN_TEST(test_a_chip_that_goes_is_noticed_without_a_request);
	RUN_TEST(test_a_chip_that_is_back_and_cannot_be_opened_is_not_called_gone);
	RUN_TEST(test_a_chip_that_cannot_be_opened_after_a_pause_says_so_again);
	RUN_TEST(test_suspended_it_holds_nothing);
	RUN_TEST(test_a_chip_is_named_or_refused);
	RUN_TEST(test_a_line_is_written_as_chip_and_line_with_words_behind);
	return UNITY_END();
}
