/* SPDX-License-Identifier: MIT */
/* Tests of the bus contract: targets and their backends, the queue of a simple bus, suspending. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/bus/backends.h"
#include "src/ground/signal/value.h"
#include "tests/unit/aid/host.h"

static struct host host;
static struct bus *bus;

/* A simple backend of depth 4 that notes what it is asked, and takes 10 ms for each. */
static uint32_t asked[16];
static unsigned n_asked, n_steps;

static void note_exec(struct bus *self, struct bus_req *req, struct bus_answer *answer)
{
	(void)answer;
	asked[n_asked++] = req->id;
	self->env->wait(self->env->ctx, -1, 0, self->env->now(self->env->ctx) + 10 * HOST_MS);
}

static int64_t note_step(struct bus *self, int64_t now)
{
	(void)self;
	n_steps++;
	return now + 500 * HOST_MS;
}

static void note_destroy(struct bus *self)
{
	free(self);
}

static const struct bus_ops note = {
	.scheme = "note", .depth = 4, .exec = note_exec, .destroy = note_destroy};
static const struct bus_ops note_stepping = {.scheme = "note",
                                             .depth = 4,
                                             .exec = note_exec,
                                             .step = note_step,
                                             .destroy = note_destroy};

static void make(const struct bus_ops *ops)
{
	bus = calloc(1, sizeof(*bus));
	TEST_ASSERT_NOT_NULL(bus);
	TEST_ASSERT_EQUAL_INT(0, bus_init(bus, ops, &host.env));
}

static struct bus_req request(uint32_t id, enum bus_prio prio)
{
	return (struct bus_req){.id = id,
	                        .op = BUS_READ,
	                        .prio = (uint8_t)prio,
	                        .path = "/x",
	                        .deadline_ns = INT64_MAX};
}

void setUp(void)
{
	host_init_virtual(&host);
	bus = NULL;
	n_asked = n_steps = 0;
}

void tearDown(void)
{
	bus_destroy(bus);
}

static void becomes(const char *target, const char *scheme)
{
	struct bus *made = host_bus(&host, target);

	TEST_ASSERT_EQUAL_STRING_MESSAGE(scheme, made->ops->scheme, target);
	bus_destroy(made);
}

static void is_refused(const char *target, int err, const char *word)
{
	char why[200] = "";
	int got = bus_create(target, &host.env, &bus, why, sizeof(why));

	TEST_ASSERT_EQUAL_INT_MESSAGE(err, got, target);
	TEST_ASSERT_NULL(bus);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, word), why);
}

static void test_a_host_alone_is_an_owserver(void)
{
	becomes("localhost", "owserver");
	becomes("localhost:4304", "owserver");
	becomes("10.1.2.3", "owserver");
	becomes("[::1]", "owserver");
	becomes("[::1]:4304", "owserver");
	becomes("", "owserver");
}

static void test_a_scheme_chooses_its_backend(void)
{
	becomes("null:", "null");
	becomes("null", "null");
	becomes("late:seed=3", "late");
	becomes("owserver:localhost:4304", "owserver");
	becomes("owserver:/run/owsd/OWS.sock", "owserver");
}

static void test_a_host_named_like_a_scheme_is_said_in_full(void)
{
	becomes("owserver:null:4304", "owserver");
	becomes("owserver:late", "owserver");
}

static void test_an_unknown_scheme_is_refused_with_the_names_there_are(void)
{
	is_refused("pci:/dev/x", -EPROTONOSUPPORT,
	           "owserver: i2c: w1: serial: uart: usb: gpio: sim:");
	is_refused("pci:", -EPROTONOSUPPORT, "'pci'");
	is_refused("foo:bar:baz", -EPROTONOSUPPORT, "'foo'");
}

/* The words of OWFS, which the DNS would be asked for else. */
static void test_an_adapter_that_others_drive_is_refused_with_the_way_to_it(void)
{
	static const char *const usb[] = {"USB", "DS9490", "DS9490R", "ds2490"};
	static const char *const serial[] = {"link", "LinkUSB", "DS9097U", "ds2480b"};
	static const char *const passive[] = {"passive", "DS9097", "/dev/ttyUSB0"};
	static const char *const i2c[] = {"i2c-1", "I2C-10", "DS2482", "ds2482-800", "DS2484"};
	static const char *const hosts[] = {"i2c-garden", "i2c-1a",  "ds2482-garden", "ds2482-",
	                                    "ds24820",    "ds2480c", "ds2413",        "ds24"};

	for (size_t i = 0; i < sizeof(usb) / sizeof(usb[0]); i++)
		is_refused(usb[i], -EINVAL, "write usb:");
	for (size_t i = 0; i < sizeof(serial) / sizeof(serial[0]); i++)
		is_refused(serial[i], -EINVAL, "serial:/dev/ttyUSB0");
	for (size_t i = 0; i < sizeof(passive) / sizeof(passive[0]); i++)
		is_refused(passive[i], -EINVAL, "uart:/dev/ttyUSB0");
	is_refused("serial:ttyUSB0", -EINVAL, "expected a device, as /dev/ttyUSB0");
	becomes("serial:/dev/ttyUSB0", "serial");
	becomes("serial", "serial");
	becomes("uart:/dev/ttyUSB0", "uart");
	is_refused("usb:all", -EINVAL, "or its place, as 1-1.4");
	becomes("usb:", "usb");
	becomes("usb", "usb");
	becomes("usb:81.3B4429000000", "usb");
	becomes("usb:1-1.4", "usb");
	for (size_t i = 0; i < sizeof(i2c) / sizeof(i2c[0]); i++)
		is_refused(i2c[i], -EINVAL, "i2c:/dev/i2c-1");
	becomes("link:4304", "owserver");
	becomes("i2c-1:4304", "owserver");
	for (size_t i = 0; i < sizeof(hosts) / sizeof(hosts[0]); i++)
		becomes(hosts[i], "owserver");
	becomes("usb2", "owserver");
	becomes("owserver:usb", "owserver");
	becomes("usb.example.org", "owserver");
}

static void test_a_wrong_port_is_called_that(void)
{
	static const char *const wrong[] = {
		"host:99999",        "host:0",      "127.0.0.1:70000", "127.0.0.1:26000x",
		"127.0.0.1:",        "localhost:",  "localhost:0",     "localhost: 26000",
		"owserver:w1:99999", "10.0.0.1:-1", "[::1]:x",
	};

	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		is_refused(wrong[i], -EINVAL, "the port '");
}

static void test_a_host_has_to_be_one(void)
{
	is_refused(":", -EINVAL, "HOST");
	is_refused(":4304", -EINVAL, "HOST");
	is_refused("[]:4304", -EINVAL, "HOST");
	is_refused("[::1", -EINVAL, "HOST");
	is_refused("[::1]4304", -EINVAL, "HOST");
	is_refused("/dev/i2c-1", -EINVAL, "i2c:/dev/i2c-1");
}

static void test_a_bare_ipv6_address_is_told_to_use_brackets(void)
{
	is_refused("fe80::1", -EINVAL, "brackets");
	is_refused("::1", -EINVAL, "brackets");
}

static void test_a_wrong_rest_is_refused_with_the_reason(void)
{
	is_refused("null:x", -EINVAL, "null:");
	is_refused("sim:", -EINVAL, "file");
	is_refused("late:speed=3", -EINVAL, "speed=3");
	is_refused("late:twice=101", -EINVAL, "twice");
}

static void test_a_simple_bus_takes_as_many_as_its_depth(void)
{
	struct bus_req req[5];

	make(&note);
	TEST_ASSERT_EQUAL_UINT(4, bus_depth(bus));
	for (uint32_t i = 0; i < 5; i++) {
		req[i] = request(i, BUS_INPUT);
		TEST_ASSERT_EQUAL_INT(i < 4 ? 0 : -EAGAIN, bus_submit(bus, &req[i]));
	}
	bus_step(bus, host.now);
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req[4]));
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 5, host.now + HOST_S));
	for (uint32_t i = 0; i < 5; i++)
		TEST_ASSERT_EQUAL_UINT32(i, host.answer[i].id);
}

static void test_one_step_does_one_request(void)
{
	struct bus_req a = request(1, BUS_INPUT), b = request(2, BUS_INPUT);

	make(&note);
	bus_submit(bus, &a);
	bus_submit(bus, &b);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(host.now, bus_step(bus, host.now));
	TEST_ASSERT_EQUAL_UINT(1, host.answers);
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, bus_step(bus, host.now));
	TEST_ASSERT_EQUAL_UINT(2, host.answers);
}

static void test_the_lowest_prio_goes_first_and_equals_keep_their_order(void)
{
	struct bus_req req[4] = {request(1, BUS_GUEST), request(2, BUS_INPUT),
	                         request(3, BUS_ALARM), request(4, BUS_INPUT)};
	const uint32_t order[4] = {3, 2, 4, 1};

	make(&note);
	for (unsigned i = 0; i < 4; i++)
		TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req[i]));
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 4, host.now + HOST_S));
	TEST_ASSERT_EQUAL_UINT32_ARRAY(order, asked, 4);
}

static void test_a_request_past_its_deadline_is_not_begun(void)
{
	struct bus_req a = request(1, BUS_INPUT), b = request(2, BUS_INPUT);

	make(&note);
	b.deadline_ns = host.now + 10 * HOST_MS;
	bus_submit(bus, &a);
	bus_submit(bus, &b);
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 2, host.now + HOST_S));
	TEST_ASSERT_EQUAL_UINT(1, n_asked);
	TEST_ASSERT_EQUAL_INT(0, host_answer(&host, 1)->err);
	TEST_ASSERT_EQUAL_INT(-ETIME, host_answer(&host, 2)->err);
}

static void test_a_reading_that_nobody_wants_is_not_begun_but_a_write_is(void)
{
	const uint32_t gone = 1;
	struct bus_req a = request(1, BUS_INPUT), b = request(2, BUS_INPUT);

	make(&note);
	a.unwanted = b.unwanted = &gone;
	b.op = BUS_WRITE;
	bus_submit(bus, &a);
	bus_submit(bus, &b);
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 2, host.now + HOST_S));
	TEST_ASSERT_EQUAL_INT(-ECANCELED, host_answer(&host, 1)->err);
	TEST_ASSERT_EQUAL_INT(0, host_answer(&host, 2)->err);
	TEST_ASSERT_EQUAL_UINT(1, n_asked);
	TEST_ASSERT_EQUAL_UINT32(2, asked[0]);
}

static void test_a_simple_bus_with_step_is_stepped_before_each_request_and_when_idle(void)
{
	struct bus_req a = request(1, BUS_INPUT);

	make(&note_stepping);
	TEST_ASSERT_EQUAL_INT64(host.now + 500 * HOST_MS, bus_step(bus, host.now));
	bus_submit(bus, &a);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(host.now, bus_step(bus, host.now));
	TEST_ASSERT_EQUAL_UINT(2, n_steps);
	TEST_ASSERT_EQUAL_UINT(1, n_asked);
}

static void test_the_queue_holds_any_mix_of_submit_and_step(void)
{
	struct bus_req req[400];
	unsigned seed = 20260, submitted = 0;

	make(&note);
	srand(seed);
	for (unsigned i = 0; i < 400; i++) {
		n_asked = 0;
		req[i] = request(i, (enum bus_prio)(rand() % 4));
		if (rand() % 3 && bus_submit(bus, &req[i]) == 0)
			submitted++;
		if (rand() % 3 == 0)
			bus_step(bus, host.now);
		TEST_ASSERT_LESS_OR_EQUAL_UINT(4, bus->count);
	}
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(submitted, host.answers, "seed 20260");
	for (unsigned i = 0; i < 400; i++)
		TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(1, host_answers(&host, i), "seed 20260");
}

static void test_a_simple_bus_without_step_is_up_from_its_first_step_and_says_so_once(void)
{
	make(&note);
	for (int i = 0; i < 3; i++)
		bus_step(bus, host.env.now(host.env.ctx));
	TEST_ASSERT_EQUAL_UINT(1, host.events);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_UP));
}

static void test_a_simple_bus_with_a_step_tells_itself_whether_it_is_up(void)
{
	make(&note_stepping);
	bus_step(bus, host.env.now(host.env.ctx));
	TEST_ASSERT_EQUAL_UINT(0, host.events);
}

static void has_text(enum ows_type type, double number)
{
	uint8_t data[BUS_NUMBER_TEXT];
	struct bus_req req = {.op = BUS_WRITE,
	                      .number = true,
	                      .single = type == OWS_FLOAT,
	                      .value = number,
	                      .data = data};
	char text[VALUE_TEXT_MAX];
	int64_t value = value_is_float(type) ? value_of_double(number) : (int64_t)number;
	int n = value_to_text(type, value, text);

	TEST_ASSERT_EQUAL_UINT_MESSAGE(n, bus_write_text(&req), text);
	TEST_ASSERT_EQUAL_MEMORY_MESSAGE(text, data, (size_t)n, text);
}

static void test_the_text_of_a_written_number_is_that_of_a_signal(void)
{
	static const double numbers[] = {0,      -0.0,  1,       -1,     0.1,
	                                 21.5,   1e15,  1e22,    1e-5,   1e-7,
	                                 5e-324, 1e300, 1.0 / 3, 2e-310, 123456789.125};

	for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++) {
		has_text(OWS_DOUBLE, numbers[i]);
		if (isfinite((float)numbers[i]))
			has_text(OWS_FLOAT, (double)(float)numbers[i]);
	}
	srandom(1);
	for (int i = 0; i < 20000; i++) {
		int64_t bits = (int64_t)((uint64_t)random() << 33 ^ (uint64_t)random() << 11 ^
		                         (uint64_t)random());
		double number = value_number(OWS_DOUBLE, bits);
		float single;

		memcpy(&single, &bits, sizeof(single));
		if (isfinite(number))
			has_text(OWS_DOUBLE, number);
		if (isfinite(single))
			has_text(OWS_FLOAT, (double)single);
		has_text(OWS_LONG, (double)(int32_t)bits);
		has_text(OWS_LARGE, (double)(bits % INT64_C(1000000000000000)));
	}
}

static void test_a_switch_takes_0_and_1_and_four_words(void)
{
	static const struct {
		const char *text;
		int on; /* below 0: refused */
	} texts[] = {{"0", 0},    {"1", 1},     {"on", 1},   {"off", 0}, {"yes", 1},
	             {"no", 0},   {" 1 \n", 1}, {"", -1},    {"2", -1},  {"01", -1},
	             {"1 0", -1}, {"ye", -1},   {"yes!", -1}};
	static const struct {
		double number;
		int on;
	} numbers[] = {{0, 0}, {1, 1}, {-0.0, 0}, {0.5, -1}, {2, -1}, {-1, -1}, {NAN, -1}};
	bool on;

	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++)
		for (uint32_t nul = 0; nul < 2; nul++) {
			struct bus_req req = {.op = BUS_WRITE,
			                      .data = (uint8_t *)(uintptr_t)texts[i].text,
			                      .len = (uint32_t)strlen(texts[i].text) + nul};

			TEST_ASSERT_EQUAL_INT(texts[i].on < 0 ? -EINVAL : 0,
			                      bus_write_switch(&req, &on));
			TEST_ASSERT_TRUE(texts[i].on < 0 || texts[i].on == on);
			req.offset = 1;
			TEST_ASSERT_EQUAL_INT(-EINVAL, bus_write_switch(&req, &on));
		}
	for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++) {
		const struct bus_req req = {
			.op = BUS_WRITE, .number = true, .value = numbers[i].number};

		TEST_ASSERT_EQUAL_INT(numbers[i].on < 0 ? -EINVAL : 0, bus_write_switch(&req, &on));
		TEST_ASSERT_TRUE(numbers[i].on < 0 || numbers[i].on == on);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_host_alone_is_an_owserver);
	RUN_TEST(test_a_scheme_chooses_its_backend);
	RUN_TEST(test_a_host_named_like_a_scheme_is_said_in_full);
	RUN_TEST(test_an_unknown_scheme_is_refused_with_the_names_there_are);
	RUN_TEST(test_an_adapter_that_others_drive_is_refused_with_the_way_to_it);
	RUN_TEST(test_a_wrong_port_is_called_that);
	RUN_TEST(test_a_host_has_to_be_one);
	RUN_TEST(test_a_bare_ipv6_address_is_told_to_use_brackets);
	RUN_TEST(test_a_wrong_rest_is_refused_with_the_reason);
	RUN_TEST(test_a_simple_bus_takes_as_many_as_its_depth);
	RUN_TEST(test_one_step_does_one_request);
	RUN_TEST(test_the_lowest_prio_goes_first_and_equals_keep_their_order);
	RUN_TEST(test_a_request_past_its_deadline_is_not_begun);
	RUN_TEST(test_a_reading_that_nobody_wants_is_not_begun_but_a_write_is);
	RUN_TEST(test_a_simple_bus_with_step_is_stepped_before_each_request_and_when_idle);
	RUN_TEST(test_the_queue_holds_any_mix_of_submit_and_step);
	RUN_TEST(test_a_simple_bus_without_step_is_up_from_its_first_step_and_says_so_once);
	RUN_TEST(test_a_simple_bus_with_a_step_tells_itself_whether_it_is_up);
	RUN_TEST(test_the_text_of_a_written_number_is_that_of_a_signal);
	RUN_TEST(test_a_switch_takes_0_and_1_and_four_words);
	return UNITY_END();
}
