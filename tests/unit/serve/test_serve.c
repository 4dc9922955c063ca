/* SPDX-License-Identifier: MIT */
/* The server with a client of ours, and with an engine that does what the test says. */
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "hal/owfs/frame.h"
#include "src/daemon/serve/serve.h"
#include "src/daemon/serve/server.h"
#include "src/ground/service/command_age.h"
#include "src/memory/shm/word.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

#define TYPE "/28.551DDF030000/type"
#define FLAGS (FRAME_PERSIST | 0x100)
#define FAHRENHEIT (UINT32_C(1) << 16)

#define ROOM \
	{ \
		.name = "room", .path = "/28.551DDF030000/temperature", .type = OWS_DOUBLE \
	}
#define RELAY \
	{ \
		.name = "relay", .path = "/29.551DDF030000/PIO.0", .type = OWS_BOOL, \
		.output = true \
	}
#define FAN \
	{ \
		.name = "fan", .path = "/29.551DDF030000/PIO.1", .type = OWS_BOOL, .output = true \
	}
static const struct instance_signal signals[] = {ROOM, RELAY, FAN};
/* after a reload */
static const struct instance_signal other_signals[] = {FAN, ROOM, RELAY};
static struct config_item items[3], other_items[3];
static struct config_target target = {.text = "null:"};
static struct config config, other_config;
static struct instance in;
static struct serve *serve;
static const struct engine_guests *port;
static char folder[] = "/tmp/owsd-serve-XXXXXX", path[64];
static int fd;
static struct frame_header reply;
static char data[256];

static atomic_bool crowd;

/* In place of the C library's: beside what is there, with a crowd, 80 others always are. */
int epoll_wait(int epoll, struct epoll_event *events, int most, int wait_ms)
{
	bool is = atomic_load(&crowd);
	int n = epoll_pwait(epoll, events, most, is && wait_ms ? 1 : wait_ms, NULL);

	for (int k = 0; is && k < 80 && n >= 0 && n < most; k++)
		events[n++] = (struct epoll_event){.data.u32 = SERVER_CLIENTS}; /* the bell */
	return n;
}

static void no_ring(void *ctx)
{
	(void)ctx;
}

static int connect_to_it(void)
{
	struct sockaddr_un to = {.sun_family = AF_UNIX};
	struct timeval limit = {.tv_sec = 60};
	int sock = socket(AF_UNIX, SOCK_STREAM, 0);

	snprintf(to.sun_path, sizeof(to.sun_path), "%s", path);
	TEST_ASSERT_EQUAL_INT(0, connect(sock, (void *)&to, sizeof(to)));
	setsockopt(sock, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
	return sock;
}

static void fill(struct config *to, struct config_item *its, const struct instance_signal *from)
{
	for (int i = 0; i < 3; i++)
		its[i] = (struct config_item){.name = from[i].name,
		                              .path = from[i].path,
		                              .type = (enum ows_type)from[i].type,
		                              .output = from[i].output};
	*to = (struct config){.targets = &target,
	                      .target_count = 1,
	                      .items = its,
	                      .item_count = 3,
	                      .serve.socket = path};
}

/* The one that came last. */
static unsigned controller(void)
{
	return instance_controllers(&in) - 1;
}

/* As the engine shows an output: enabled, and the last command that reached the bus. */
static void show_output(uint32_t record, uint32_t applied)
{
	struct ows_sample sample = {.quality = OWS_Q_GOOD, .measured_ns = ows_now()};
	struct ows_attrs attrs = {.flags = OWS_ATTR_WRITE_ENABLE};

	if (applied)
		controller_applied(instance_controller(&in, controller()), record, applied);
	image_publish(&in.image, record, &sample, &attrs, NULL);
	image_news(&in.image);
}

static void target_is_up(void)
{
	__atomic_store_n(&in.image.targets[0].state, 1, __ATOMIC_RELAXED);
}

void setUp(void)
{
	struct serve_setup setup = {.config = &config,
	                            .dir = folder_dir()->path,
	                            .directory = folder_dir()->fd,
	                            .ring = no_ring};
	char name[24], why[128];

	serve = NULL;
	fd = -1;
	atomic_store(&crowd, false);
	snprintf(name, sizeof(name), "serve-%d", (int)getpid());
	instance_start(&in, name, signals, 3);
	show_output(2, 0);
	show_output(3, 0);
	strcpy(folder, "/tmp/owsd-serve-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/s", folder);
	fill(&config, items, signals);
	fill(&other_config, other_items, other_signals);
	setup.instance = in.name;
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, serve_create(&setup, &serve, why, sizeof(why)), why);
	port = serve_guests(serve);
	TEST_ASSERT_EQUAL_INT(0, serve_start(serve, &in.image));
	fd = connect_to_it();
}

void tearDown(void)
{
	if (fd >= 0)
		close(fd);
	serve_stop(serve);
	serve_destroy(serve);
	rmdir(folder);
	instance_end(&in);
}

static void ask(int sock, enum frame_type type, const char *what)
{
	static uint8_t frame[FRAME_REQUEST_MAX];
	int n = frame_request(frame, type, FLAGS, 64, what, NULL, 0);

	TEST_ASSERT_EQUAL_INT(n, send(sock, frame, (size_t)n, MSG_NOSIGNAL));
}

/* The next answer that is no keep-alive; its return code. */
static int32_t answer(int sock)
{
	uint8_t head[FRAME_HEADER];

	do {
		TEST_ASSERT_EQUAL_INT(FRAME_HEADER, recv(sock, head, sizeof(head), MSG_WAITALL));
		frame_get_header(head, &reply);
	} while (reply.payload < 0);
	TEST_ASSERT_LESS_THAN_INT32(sizeof(data), reply.payload);
	memset(data, 0, sizeof(data));
	if (reply.payload)
		TEST_ASSERT_EQUAL_INT(reply.payload,
		                      recv(sock, data, (size_t)reply.payload, MSG_WAITALL));
	return reply.type;
}

/* The server takes requests in turn: who is answered now came after all that was asked before. */
static void until_it_has_seen_all(void)
{
	int sock = connect_to_it();

	ask(sock, FRAME_NOP, NULL);
	TEST_ASSERT_EQUAL_INT(0, answer(sock));
	close(sock);
}

/* But for keep-alives, of which there is one when this takes a second. */
static bool is_silent(int sock)
{
	uint8_t head[FRAME_HEADER];
	ssize_t n;

	until_it_has_seen_all();
	while ((n = recv(sock, head, sizeof(head), MSG_DONTWAIT | MSG_PEEK)) > 0) {
		n = recv(sock, head, sizeof(head), MSG_WAITALL);
		frame_get_header(head, &reply);
		if (n != FRAME_HEADER || reply.payload >= 0)
			return false;
	}
	return n < 0 && errno == EAGAIN;
}

static struct engine_guest *next_guest(void)
{
	struct engine_guest *g = NULL;

	for (int i = 0; i < 60000 && !g; i++) {
		g = port->take(port->ctx);
		if (!g)
			usleep(1000); /* pace */
	}
	TEST_ASSERT_NOT_NULL(g);
	return g;
}

static void give(struct engine_guest *g, const char *text)
{
	g->answer = (struct bus_answer){.len = (uint32_t)strlen(text), .measured_ns = ows_now()};
	memcpy(g->data, text, strlen(text));
	port->answered(port->ctx, g);
}

static uint64_t counted(const char *name)
{
	size_t n;
	const struct bus_counter *c = serve_counters(serve, &n);

	for (size_t i = 0; i < n; i++)
		if (strcmp(c[i].name, name) == 0)
			return bus_counted(&c[i]);
	TEST_FAIL_MESSAGE(name);
	return 0;
}

static void wait_for(const char *name, uint64_t value)
{
	for (int i = 0; i < 60000 && counted(name) != value; i++)
		usleep(1000); /* pace */
	TEST_ASSERT_EQUAL_UINT64(value, counted(name));
}

static void test_what_is_not_known_here_is_asked_of_the_engine_once(void)
{
	struct engine_guest *g;

	ask(fd, FRAME_READ, TYPE);
	g = next_guest();
	TEST_ASSERT_EQUAL_STRING(TYPE, g->path);
	TEST_ASSERT_EQUAL_INT(BUS_READ, g->op);
	TEST_ASSERT_EQUAL_INT(GUEST_ANY_LANE, g->lane);
	give(g, "DS18B20");
	TEST_ASSERT_EQUAL_INT(7, answer(fd));
	TEST_ASSERT_EQUAL_STRING("DS18B20", data);
	TEST_ASSERT_EQUAL_HEX32(FLAGS, reply.flags);
	ask(fd, FRAME_READ, TYPE);
	TEST_ASSERT_EQUAL_INT(7, answer(fd));
	TEST_ASSERT_NULL(port->take(port->ctx));
	TEST_ASSERT_EQUAL_UINT64(1, counted("served_kept_answers"));
}

static void test_an_input_of_the_table_is_answered_from_the_image(void)
{
	/* new however long it takes until it is asked for */
	instance_put_double(&in, 1, 21.5, ows_now() + INSTANCE_PATIENCE / 2);
	ask(fd, FRAME_READ, "/28.551DDF030000/temperature");
	TEST_ASSERT_EQUAL_INT(12, answer(fd));
	TEST_ASSERT_EQUAL_STRING("        21.5", data);
	TEST_ASSERT_NULL(port->take(port->ctx));
	/* too old: the bus is asked */
	instance_put_double(&in, 1, 22.5, ows_now() - 3 * INSTANCE_S);
	ask(fd, FRAME_READ, "/28.551DDF030000/temperature");
	give(next_guest(), "          23");
	TEST_ASSERT_EQUAL_INT(12, answer(fd));
	TEST_ASSERT_EQUAL_STRING("          23", data);
}

static void test_an_input_from_before_a_write_to_its_device_does_not_answer(void)
{
	static uint8_t frame[FRAME_REQUEST_MAX];
	int n = frame_request(frame, FRAME_WRITE, FLAGS, 2, "/28.551DDF030000/temphigh",
	                      (const uint8_t *)"30", 2);

	instance_put_double(&in, 1, 21.5, ows_now());
	TEST_ASSERT_EQUAL_INT(n, send(fd, frame, (size_t)n, MSG_NOSIGNAL));
	struct engine_guest *g = next_guest();
	TEST_ASSERT_EQUAL_INT(BUS_WRITE, g->op);
	instance_put_double(&in, 1, 22.5, ows_now());
	g->answer = (struct bus_answer){.len = 2};
	port->answered(port->ctx, g);
	TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, answer(fd));
	ask(fd, FRAME_READ, "/28.551DDF030000/temperature");
	give(next_guest(), "          23");
	TEST_ASSERT_EQUAL_INT(12, answer(fd));
	TEST_ASSERT_EQUAL_STRING("          23", data);
	/* What is measured after it does. */
	instance_put_double(&in, 1, 24.5, ows_now() + INSTANCE_PATIENCE / 2);
	ask(fd, FRAME_READ, "/28.551DDF030000/temperature");
	TEST_ASSERT_EQUAL_INT(12, answer(fd));
	TEST_ASSERT_EQUAL_STRING("        24.5", data);
}

static void give_address(const char *asked, const char *address)
{
	struct engine_guest *g = next_guest();

	TEST_ASSERT_EQUAL_STRING(asked, g->path);
	TEST_ASSERT_EQUAL_INT(BUS_READ, g->op);
	give(g, address);
}

/* An alias may name any device, also where its family was asked for to convert the units. */
static void test_a_write_by_an_alias_forgets_what_was_read_in_all_units(void)
{
	static uint8_t frame[FRAME_REQUEST_MAX];
	int n = frame_request(frame, FRAME_WRITE, FLAGS | FAHRENHEIT, 2, "/kitchen/temphigh",
	                      (const uint8_t *)"86", 2);
	struct engine_guest *g;

	ask(fd, FRAME_READ, TYPE);
	give(next_guest(), "DS18B20");
	TEST_ASSERT_EQUAL_INT(7, answer(fd));
	TEST_ASSERT_EQUAL_INT(n, send(fd, frame, (size_t)n, MSG_NOSIGNAL));
	give_address("/kitchen/address", "28551DDF03000034");
	g = next_guest();
	TEST_ASSERT_EQUAL_STRING("/kitchen/family", g->path);
	give(g, "28");
	g = next_guest();
	TEST_ASSERT_EQUAL_STRING("/kitchen/temphigh", g->path);
	TEST_ASSERT_EQUAL_STRING_LEN("30", g->data, g->len);
	g->answer = (struct bus_answer){.len = 2};
	port->answered(port->ctx, g);
	TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, answer(fd));
	ask(fd, FRAME_READ, TYPE);
	until_it_has_seen_all();
	TEST_ASSERT_EQUAL_UINT64(0, counted("served_kept_answers"));
	give(next_guest(), "DS18B20");
	TEST_ASSERT_EQUAL_INT(7, answer(fd));
}

static void test_what_was_read_before_a_device_was_found_absent_answers_nobody(void)
{
	struct engine_guest *g;

	ask(fd, FRAME_READ, "/28.551DDF030000/templow");
	give(next_guest(), "          10");
	TEST_ASSERT_EQUAL_INT(12, answer(fd));
	ask(fd, FRAME_READ, "/uncached/28.551DDF030000/id");
	g = next_guest();
	g->answer = (struct bus_answer){.err = -ENODEV};
	port->answered(port->ctx, g);
	TEST_ASSERT_LESS_THAN_INT32(0, answer(fd));
	ask(fd, FRAME_READ, "/28.551DDF030000/templow");
	g = next_guest();
	g->answer = (struct bus_answer){.err = -ENODEV};
	port->answered(port->ctx, g);
	TEST_ASSERT_LESS_THAN_INT32(0, answer(fd));
}

static void test_one_request_of_a_client_is_worked_on_at_a_time(void)
{
	struct engine_guest *g;
	int other = connect_to_it();

	ask(fd, FRAME_READ, "/28.551DDF030000/id");
	ask(fd, FRAME_READ, "/28.551DDF030000/family");
	g = next_guest();
	ask(other, FRAME_READ, "/28.551DDF030000/crc8");
	give(next_guest(), "AB");
	TEST_ASSERT_EQUAL_INT(2, answer(other));
	TEST_ASSERT_NULL(port->take(port->ctx));
	give(g, "551DDF030000");
	TEST_ASSERT_EQUAL_INT(12, answer(fd));
	give(next_guest(), "28");
	TEST_ASSERT_EQUAL_INT(2, answer(fd));
	close(other);
}

/* What a bus still has of a connection is not used for the next request. */
static void test_who_was_given_up_waits_for_his_room_before_the_next_request(void)
{
	struct engine_guest *g;

	ask(fd, FRAME_READ, TYPE);
	g = next_guest();
	g->answer = (struct bus_answer){.err = -ETIMEDOUT};
	g->lent = true;
	port->answered(port->ctx, g);
	TEST_ASSERT_EQUAL_INT(-5, answer(fd));
	ask(fd, FRAME_NOP, NULL);
	TEST_ASSERT_TRUE(is_silent(fd));
	memcpy(g->data, "late", 4);
	port->released(port->ctx, g);
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
	TEST_ASSERT_EQUAL_INT(0, reply.payload);
}

/* The engine learns of it while it works on the request. */
static void test_who_hangs_up_wants_no_answer(void)
{
	struct engine_guest *g;

	ask(fd, FRAME_READ, TYPE);
	g = next_guest();
	TEST_ASSERT_EQUAL_UINT32(0, __atomic_load_n(&g->unwanted, __ATOMIC_RELAXED));
	close(fd);
	fd = -1; /* tearDown() closes no descriptor that another thread has made of this number */
	for (int i = 0; i < 60000 && !__atomic_load_n(&g->unwanted, __ATOMIC_RELAXED); i++)
		usleep(1000); /* pace */
	TEST_ASSERT_EQUAL_UINT32(1, __atomic_load_n(&g->unwanted, __ATOMIC_RELAXED));
	g->answer = (struct bus_answer){.err = -ECANCELED};
	port->answered(port->ctx, g);
	wait_for("served_clients", 0);
	/* The place of the connection serves the next one. */
	fd = connect_to_it();
	ask(fd, FRAME_READ, TYPE);
	g = next_guest();
	TEST_ASSERT_EQUAL_UINT32(0, __atomic_load_n(&g->unwanted, __ATOMIC_RELAXED));
	give(g, "DS18B20");
	TEST_ASSERT_EQUAL_INT(7, answer(fd));
}

static void test_who_came_while_no_descriptor_was_left_is_served_once_there_is_one(void)
{
	int sock = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0), lowest = dup(sock);
	const struct timeval limit = {.tv_sec = 20};
	struct sockaddr_un to = {.sun_family = AF_UNIX};
	struct rlimit before, none;

	/* the first one has its descriptor by then */
	ask(fd, FRAME_NOP, NULL);
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
	snprintf(to.sun_path, sizeof(to.sun_path), "%s", path);
	setsockopt(sock, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
	TEST_ASSERT_EQUAL_INT(0, getrlimit(RLIMIT_NOFILE, &before));
	none = (struct rlimit){.rlim_cur = (rlim_t)lowest, .rlim_max = before.rlim_max};
	close(lowest);
	TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &none));
	TEST_ASSERT_EQUAL_INT(0, connect(sock, (void *)&to, sizeof(to)));
	/* it looks for connections before it answers */
	ask(fd, FRAME_NOP, NULL);
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
	TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &before));
	ask(sock, FRAME_NOP, NULL);
	TEST_ASSERT_EQUAL_INT(0, answer(sock));
	close(sock);
}

static void give_up(struct engine_guest *g)
{
	g->answer = (struct bus_answer){.err = -ETIMEDOUT};
	g->lent = true;
	port->answered(port->ctx, g);
}

/* The bus may send it yet. */
static void test_what_a_bus_still_has_to_write_stays_as_it_was(void)
{
	static const char text[] = "written late";
	uint8_t frames[256];
	struct engine_guest *g;
	int n = frame_request(frames, FRAME_WRITE, FLAGS, sizeof(text), "/2D.551DDF030000/memory",
	                      (const uint8_t *)text, sizeof(text));

	for (int i = 0; i < 5; i++)
		n += frame_request(frames + n, FRAME_NOP, FLAGS, 0, NULL, NULL, 0);
	TEST_ASSERT_EQUAL_INT(n, send(fd, frames, (size_t)n, MSG_NOSIGNAL));
	g = next_guest();
	TEST_ASSERT_EQUAL_INT(BUS_WRITE, g->op);
	give_up(g);
	TEST_ASSERT_EQUAL_INT(-5, answer(fd));
	TEST_ASSERT_TRUE(is_silent(fd));
	TEST_ASSERT_EQUAL_UINT32(sizeof(text), g->len);
	TEST_ASSERT_EQUAL_STRING(text, g->data);
	port->released(port->ctx, g);
	for (int i = 0; i < 5; i++)
		TEST_ASSERT_EQUAL_INT(0, answer(fd));
}

static void test_a_write_of_this_moment_is_not_called_old_in_a_crowd(void)
{
	static const char text[] = "written now";
	uint8_t frame[256];
	int n = frame_request(frame, FRAME_WRITE, FLAGS, sizeof(text), "/2D.551DDF030000/memory",
	                      (const uint8_t *)text, sizeof(text));

	atomic_store(&crowd, true);
	usleep((COMMAND_OLD_NS + COMMAND_OLD_NS / 10) / 1000); /* longer than a write may wait */
	TEST_ASSERT_EQUAL_INT(n, send(fd, frame, (size_t)n, MSG_NOSIGNAL));
	TEST_ASSERT_TRUE(is_silent(fd));
	give(next_guest(), "");
	atomic_store(&crowd, false);
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
}

static void test_the_room_of_a_look_for_buses_is_kept_until_it_is_back(void)
{
	struct engine_guest *g, *others[3];
	int socks[4];

	target_is_up();
	ask(fd, FRAME_READ, "/bus.3/28.551DDF030000/type");
	g = next_guest();
	TEST_ASSERT_EQUAL_INT(BUS_DIR, g->op);
	give_up(g);
	TEST_ASSERT_EQUAL_INT(-5, answer(fd));
	for (int i = 0; i < 4; i++) {
		socks[i] = connect_to_it();
		ask(socks[i], FRAME_DIRALL, "/28.551DDF030000");
		if (i < 3)
			others[i] = next_guest();
	}
	until_it_has_seen_all();
	TEST_ASSERT_NULL(port->take(port->ctx));
	port->released(port->ctx, g);
	give(next_guest(), "/28.551DDF030000/id\n");
	TEST_ASSERT_EQUAL_INT(0, answer(socks[3]));
	for (int i = 0; i < 3; i++)
		give(others[i], "/28.551DDF030000/id\n");
	for (int i = 0; i < 4; i++)
		close(socks[i]);
}

static void test_a_list_that_was_made_while_targets_changed_is_none(void)
{
	struct engine_guest *g;

	target_is_up();
	ask(fd, FRAME_DIRALL, "/");
	g = next_guest();
	g->generation++;
	give(g, "/28.551DDF030000\n");
	TEST_ASSERT_EQUAL_INT(-5, answer(fd));
	ask(fd, FRAME_DIRALL, "/");
	give(next_guest(), "/28.551DDF030000\n");
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
}

static void command(const char *what)
{
	uint8_t frame[128];
	int n = frame_request(frame, FRAME_WRITE, FLAGS, 1, what, (const uint8_t *)"1", 1);

	TEST_ASSERT_EQUAL_INT(n, send(fd, frame, (size_t)n, MSG_NOSIGNAL));
}

/* The stamp of a record's command, when there is one, which the engine takes. */
static uint32_t stamp_of(uint32_t record)
{
	uint32_t found = 0;

	for (int i = 0; i < 60000 && !found; i++) {
		if (instance_controllers(&in) > 0)
			found = word_get(&instance_slot(&in, controller(), record)->stamp);
		if (!found)
			usleep(1000); /* pace */
	}
	TEST_ASSERT_NOT_EQUAL_UINT32(0, found);
	controller_taken(instance_controller(&in, controller()), record, found, 0);
	return found;
}

static void test_a_command_is_waited_for_over_a_reload(void)
{
	static const int ports[] = {0};
	uint32_t stamp;

	command("/signals/relay");
	stamp = stamp_of(2);
	instance_reload(&in, other_signals, 3);
	TEST_ASSERT_EQUAL_INT(0, serve_prepare(serve, &other_config));
	serve_reload(serve, &other_config, &in.image, ports);
	TEST_ASSERT_TRUE(is_silent(fd));
	show_output(3, stamp);
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
}

/* Another program of the user has the last seat; values need none. */
static void test_signals_are_read_after_a_reload_though_the_server_may_not_command(void)
{
	static const int ports[] = {0};

	door_lie(in.door, DOOR_REFUSES);
	command("/signals/relay");
	TEST_ASSERT_LESS_THAN_INT32(0, answer(fd));
	instance_reload(&in, other_signals, 3);
	instance_lives_on(&in);
	TEST_ASSERT_EQUAL_INT(0, serve_prepare(serve, &other_config));
	serve_reload(serve, &other_config, &in.image, ports);
	instance_put_double(&in, 2, 21.5, ows_now());
	for (int i = 0, n = 0; i < 60000 && n <= 0; i++) {
		ask(fd, FRAME_READ, "/signals/room");
		n = answer(fd);
	}
	TEST_ASSERT_EQUAL_STRING("21.5", data);
	door_lie(in.door, DOOR_HONEST);
	show_output(3, 0);
	command("/signals/relay");
	show_output(3, stamp_of(3));
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
}

/* Beside owsd a write would show an output as good that is another. */
static void test_an_alias_of_the_device_of_an_output_is_that_device(void)
{
	struct engine_guest *g;

	command("/pump/PIO.0");
	give_address("/pump/address", "29551DDF03000009");
	show_output(2, stamp_of(2));
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
	command("/pump/PIO.BYTE");
	give_address("/pump/address", "29551DDF03000009");
	TEST_ASSERT_EQUAL_INT(-30, answer(fd));
	TEST_ASSERT_NULL(port->take(port->ctx));
	/* another property of it, and another device */
	command("/pump/latch.0");
	give_address("/pump/address", "29551DDF03000009");
	g = next_guest();
	TEST_ASSERT_EQUAL_STRING("/pump/latch.0", g->path);
	TEST_ASSERT_EQUAL_INT(BUS_WRITE, g->op);
	g->answer = (struct bus_answer){.len = 1};
	port->answered(port->ctx, g);
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
	command("/lamp/PIO.0");
	give_address("/lamp/address", "28551DDF03000034");
	g = next_guest();
	TEST_ASSERT_EQUAL_STRING("/lamp/PIO.0", g->path);
	g->answer = (struct bus_answer){.len = 1};
	port->answered(port->ctx, g);
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
	/* no device has that name: it is a line of a chip, or a button of the simulator */
	command("/simulator/PIO.0");
	g = next_guest();
	TEST_ASSERT_EQUAL_STRING("/simulator/address", g->path);
	g->answer = (struct bus_answer){.err = -ENOENT};
	port->answered(port->ctx, g);
	g = next_guest();
	TEST_ASSERT_EQUAL_STRING("/simulator/PIO.0", g->path);
	TEST_ASSERT_EQUAL_INT(BUS_WRITE, g->op);
	g->answer = (struct bus_answer){.len = 1};
	port->answered(port->ctx, g);
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
	/* nobody knows which device it is */
	command("/lamp/PIO.0");
	g = next_guest();
	g->answer = (struct bus_answer){.err = -ETIMEDOUT};
	port->answered(port->ctx, g);
	TEST_ASSERT_LESS_THAN_INT32(0, answer(fd));
	command("/lamp/PIO.0");
	give_address("/lamp/address", "2955");
	TEST_ASSERT_EQUAL_INT(-5, answer(fd));
	TEST_ASSERT_NULL(port->take(port->ctx));
}

static void write_reaches(const char *what)
{
	struct engine_guest *g = next_guest();

	TEST_ASSERT_EQUAL_STRING(what, g->path);
	TEST_ASSERT_EQUAL_INT(BUS_WRITE, g->op);
	g->answer = (struct bus_answer){.len = 1};
	port->answered(port->ctx, g);
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
}

static void alias_fails(int err)
{
	struct engine_guest *g = next_guest();

	TEST_ASSERT_EQUAL_STRING("/pump/address", g->path);
	g->answer = (struct bus_answer){.err = err};
	port->answered(port->ctx, g);
}

/* As beside an output that the table has by an id. */
static void test_the_device_of_an_output_with_an_alias_is_that_output_by_its_id_too(void)
{
	static const struct instance_signal aliased[] = {
		ROOM,
		{.name = "valve", .path = "/pump/PIO.0", .type = OWS_BOOL, .output = true},
		FAN};
	static const int ports[] = {0};

	instance_reload(&in, aliased, 3);
	fill(&other_config, other_items, aliased);
	TEST_ASSERT_EQUAL_INT(0, serve_prepare(serve, &other_config));
	serve_reload(serve, &other_config, &in.image, ports);
	show_output(2, 0);
	show_output(3, 0);
	command("/29.551DDF030001/PIO.0");
	give_address("/pump/address", "29551DDF030001");
	show_output(2, stamp_of(2));
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
	command("/29.551DDF030001/PIO.BYTE");
	give_address("/pump/address", "29551DDF030001");
	TEST_ASSERT_EQUAL_INT(-30, answer(fd));
	command("/boiler/PIO.BYTE");
	give_address("/boiler/address", "29551DDF030001");
	give_address("/pump/address", "29551DDF030001");
	TEST_ASSERT_EQUAL_INT(-30, answer(fd));
	/* another device, another property, and an alias that nobody knows */
	command("/29.551DDF030002/PIO.0");
	give_address("/pump/address", "29551DDF030001");
	write_reaches("/29.551DDF030002/PIO.0");
	command("/29.551DDF030001/latch.0");
	write_reaches("/29.551DDF030001/latch.0");
	command("/29.551DDF030001/PIO.0");
	alias_fails(-ENOENT);
	write_reaches("/29.551DDF030001/PIO.0");
	/* nobody has said which device it is */
	command("/29.551DDF030001/PIO.0");
	alias_fails(-ETIMEDOUT);
	TEST_ASSERT_LESS_THAN_INT32(0, answer(fd));
	TEST_ASSERT_NULL(port->take(port->ctx));
}

/* Just then: the new image is shown, and the server has not been told yet. */
static void test_a_path_means_its_own_output_in_the_middle_of_a_reload(void)
{
	instance_reload(&in, other_signals, 3);
	show_output(1, 0);
	show_output(3, 0);
	command("/29.551DDF030000/PIO.1");
	show_output(1, stamp_of(1));
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
	TEST_ASSERT_EQUAL_UINT32(0, instance_slot(&in, 0, 3)->stamp);
}

static void test_who_left_in_the_middle_makes_room_when_the_engine_is_done(void)
{
	struct engine_guest *lost, *lent;
	int first = connect_to_it(), second = connect_to_it();

	ask(first, FRAME_READ, TYPE);
	lost = next_guest();
	ask(second, FRAME_DIRALL, "/28.551DDF030000");
	lent = next_guest();
	close(first);
	close(second);
	wait_for("served_clients", 1);
	give(lost, "DS18B20");
	lent->answer = (struct bus_answer){.err = -ETIMEDOUT};
	lent->lent = true;
	port->answered(port->ctx, lent);
	ask(fd, FRAME_NOP, NULL);
	TEST_ASSERT_EQUAL_INT(0, answer(fd));
	port->released(port->ctx, lent);
	/* four directories at a time: the one that was lent is free again */
	for (int i = 0; i < 5; i++) {
		ask(fd, FRAME_DIRALL, "/28.551DDF030000");
		give(next_guest(), "/28.551DDF030000/type\n");
		TEST_ASSERT_EQUAL_INT(0, answer(fd));
		TEST_ASSERT_EQUAL_STRING("/28.551DDF030000/type", data);
	}
}

static void test_directories_wait_for_each_other_when_all_rooms_are_taken(void)
{
	struct engine_guest *g[4];
	int socks[6];

	for (int i = 0; i < 6; i++) {
		socks[i] = connect_to_it();
		ask(socks[i], FRAME_DIRALL, "/28.551DDF030000");
		if (i < 4)
			g[i] = next_guest();
	}
	until_it_has_seen_all();
	TEST_ASSERT_NULL(port->take(port->ctx));
	/* one of those who wait goes, the other is served all the same */
	close(socks[5]);
	for (int i = 0; i < 4; i++)
		give(g[i], "/28.551DDF030000/id\n");
	give(next_guest(), "/28.551DDF030000/id\n");
	for (int i = 0; i < 5; i++) {
		TEST_ASSERT_EQUAL_INT(0, answer(socks[i]));
		close(socks[i]);
	}
	wait_for("served_clients", 1);
	TEST_ASSERT_NULL(port->take(port->ctx));
}

/* The path was removed by hand, and another owsd has begun there: NAME.sock is its, too. */
static void test_the_sockets_of_another_server_in_their_place_stay(void)
{
	struct serve_setup setup = {.config = &config,
	                            .instance = in.name,
	                            .dir = folder_dir()->path,
	                            .directory = folder_dir()->fd,
	                            .ring = no_ring};
	struct serve *other = NULL;
	char why[128];

	TEST_ASSERT_EQUAL_INT(0, unlink(path));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, serve_create(&setup, &other, why, sizeof(why)), why);
	serve_stop(serve);
	TEST_ASSERT_EQUAL_INT(0, access(path, F_OK));
	TEST_ASSERT_EQUAL_INT(0, access(folder_file(in.name, "sock"), F_OK));
	serve_destroy(other);
	TEST_ASSERT_EQUAL_INT(-1, access(path, F_OK));
	TEST_ASSERT_EQUAL_INT(-1, access(folder_file(in.name, "sock"), F_OK));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_is_not_known_here_is_asked_of_the_engine_once);
	RUN_TEST(test_an_input_of_the_table_is_answered_from_the_image);
	RUN_TEST(test_an_input_from_before_a_write_to_its_device_does_not_answer);
	RUN_TEST(test_a_write_by_an_alias_forgets_what_was_read_in_all_units);
	RUN_TEST(test_what_was_read_before_a_device_was_found_absent_answers_nobody);
	RUN_TEST(test_one_request_of_a_client_is_worked_on_at_a_time);
	RUN_TEST(test_who_was_given_up_waits_for_his_room_before_the_next_request);
	RUN_TEST(test_what_a_bus_still_has_to_write_stays_as_it_was);
	RUN_TEST(test_a_write_of_this_moment_is_not_called_old_in_a_crowd);
	RUN_TEST(test_the_room_of_a_look_for_buses_is_kept_until_it_is_back);
	RUN_TEST(test_a_list_that_was_made_while_targets_changed_is_none);
	RUN_TEST(test_a_command_is_waited_for_over_a_reload);
	RUN_TEST(test_signals_are_read_after_a_reload_though_the_server_may_not_command);
	RUN_TEST(test_an_alias_of_the_device_of_an_output_is_that_device);
	RUN_TEST(test_the_device_of_an_output_with_an_alias_is_that_output_by_its_id_too);
	RUN_TEST(test_a_path_means_its_own_output_in_the_middle_of_a_reload);
	RUN_TEST(test_who_left_in_the_middle_makes_room_when_the_engine_is_done);
	RUN_TEST(test_directories_wait_for_each_other_when_all_rooms_are_taken);
	RUN_TEST(test_who_hangs_up_wants_no_answer);
	RUN_TEST(test_who_came_while_no_descriptor_was_left_is_served_once_there_is_one);
	RUN_TEST(test_the_sockets_of_another_server_in_their_place_stay);
	return UNITY_END();
}
