/* SPDX-License-Identifier: MIT */
/* A control room, the engine's side of it, and the programs that connect to it. */
#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "hal/bus/bus.h"
#include "src/memory/shm/porter.h"
#include "tests/unit/aid/control_scene.h"

struct control *control_room;
struct config control_config;

static struct config_item items[3];
static struct controller_layout layouts[2];
static unsigned layout_at;
static char directory[64];
static int directory_fd = -1;
static sem_t bell;
static pthread_t engine;
static struct porter *porter;
static bool engine_ends, reloads, rings_news;
static struct control_message messages[OWS_CONTROLLERS];
static uint32_t
	serials[OWS_CONTROLLERS]; /* of the controllers that are inside: the test looks at them */
static uint32_t joined, left;

static void ring(void *ctx)
{
	(void)ctx;
	sem_post(&bell);
}

static void take_reload(void)
{
	struct control_message message;
	unsigned seat = 0;

	if (!__atomic_load_n(&reloads, __ATOMIC_ACQUIRE))
		return;
	while (control_prepared(control_room, &seat, &message))
		messages[message.seat] = message;
	__atomic_store_n(&reloads, false, __ATOMIC_RELEASE);
}

static void ring_news(void)
{
	if (!__atomic_load_n(&rings_news, __ATOMIC_ACQUIRE))
		return;
	control_news(control_room, NULL);
	__atomic_store_n(&rings_news, false, __ATOMIC_RELEASE);
}

static void *run(void *arg)
{
	struct control_message message;

	(void)arg;
	while (!__atomic_load_n(&engine_ends, __ATOMIC_ACQUIRE)) {
		sem_wait(&bell);
		while (control_next(control_room, &message)) {
			if (message.joins)
				messages[message.seat] = message;
			__atomic_store_n(&serials[message.seat],
			                 message.joins ? message.controller.who.serial : 0,
			                 __ATOMIC_RELEASE);
			__atomic_fetch_add(message.joins ? &joined : &left, 1, __ATOMIC_SEQ_CST);
			control_done(control_room, &message);
		}
		take_reload();
		ring_news();
	}
	return NULL;
}

static void make_layout(unsigned generation)
{
	const uint8_t types[] = {OWS_BOOL, OWS_DOUBLE, OWS_STRING};
	const struct controller_plan plan = {.types = types,
	                                     .signal_count = 3,
	                                     .text_cap = 64,
	                                     .generation = generation,
	                                     .start_id = 100 + generation};

	layout_at = generation % 2;
	controller_layout_free(&layouts[layout_at]);
	TEST_ASSERT_EQUAL(0, controller_layout_make(&layouts[layout_at], &plan));
}

void control_open(void)
{
	struct control_setup setup = {.config = &control_config, .instance = "OWS", .ring = ring};
	char why[200] = "";
	int err;

	items[0] = (struct config_item){.name = "pump_1", .type = OWS_BOOL, .output = true};
	items[1] = (struct config_item){.name = "pump_2", .type = OWS_DOUBLE, .output = true};
	items[2] = (struct config_item){.name = "valve", .type = OWS_STRING, .output = true};
	control_config.items = items;
	control_config.item_count = 3;
	snprintf(directory, sizeof(directory), "/tmp/owsd-control-%d", (int)getpid());
	TEST_ASSERT_TRUE(mkdir(directory, 0755) == 0 || errno == EEXIST);
	directory_fd = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	TEST_ASSERT_GREATER_OR_EQUAL(0, directory_fd);
	make_layout(1);
	setup.directory = directory_fd;
	sem_init(&bell, 0, 0);
	joined = left = 0;
	memset(serials, 0, sizeof(serials));
	engine_ends = reloads = rings_news = false;
	TEST_ASSERT_EQUAL(0, porter_start(&porter));
	setup.porter = porter;
	err = control_create(&setup, &control_room, why, sizeof(why));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, err, why);
	TEST_ASSERT_EQUAL(0, pthread_create(&engine, NULL, run, NULL));
	TEST_ASSERT_EQUAL(0, control_start(control_room, &layouts[layout_at]));
}

void control_close(void)
{
	if (!control_room)
		return;
	__atomic_store_n(&engine_ends, true, __ATOMIC_RELEASE);
	sem_post(&bell);
	pthread_join(engine, NULL);
	control_destroy(control_room);
	control_room = NULL;
	porter_end(porter);
	controller_layout_free(&layouts[0]);
	controller_layout_free(&layouts[1]);
	close(directory_fd);
	rmdir(directory);
	sem_destroy(&bell);
	control_config = (struct config){0};
}

static void pause_ms(int64_t *left_ms, const char *what)
{
	const struct timespec ms = {.tv_nsec = 1000000};

	TEST_ASSERT_TRUE_MESSAGE((*left_ms)-- > 0, what);
	nanosleep(&ms, NULL); /* pace */
}

void control_reload(void)
{
	int64_t left_ms = CONTROL_SCENE_MS;

	make_layout(layouts[layout_at].header.generation + 1);
	control_prepare(control_room, &control_config, &layouts[layout_at]);
	__atomic_store_n(&reloads, true, __ATOMIC_RELEASE);
	sem_post(&bell);
	while (__atomic_load_n(&reloads, __ATOMIC_ACQUIRE))
		pause_ms(&left_ms, "the reload");
	control_reloaded(control_room);
}

void control_ring_news(void)
{
	int64_t left_ms = CONTROL_SCENE_MS;

	__atomic_store_n(&rings_news, true, __ATOMIC_RELEASE);
	sem_post(&bell);
	while (__atomic_load_n(&rings_news, __ATOMIC_ACQUIRE))
		pause_ms(&left_ms, "the news");
}

unsigned control_joined(void)
{
	return __atomic_load_n(&joined, __ATOMIC_SEQ_CST);
}

unsigned control_left(void)
{
	return __atomic_load_n(&left, __ATOMIC_SEQ_CST);
}

unsigned control_inside(void)
{
	return control_joined() - control_left();
}

const struct control_message *control_message_of(uint32_t serial)
{
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		if (__atomic_load_n(&serials[i], __ATOMIC_ACQUIRE) == serial)
			return &messages[i];
	TEST_FAIL_MESSAGE("no controller with that serial");
	return NULL;
}

uint64_t control_count(const char *name)
{
	size_t n;
	const struct bus_counter *counters = control_counters(control_room, &n);

	for (size_t i = 0; i < n; i++)
		if (strcmp(counters[i].name, name) == 0)
			return bus_counted(&counters[i]);
	TEST_FAIL_MESSAGE(name);
	return 0;
}

void control_wait_count(const char *name, uint64_t count)
{
	int64_t left_ms = CONTROL_SCENE_MS;

	while (control_count(name) != count)
		pause_ms(&left_ms, name);
}

/* --- Programs --------------------------------------------------------------------------------- */

int control_connect(void)
{
	struct sockaddr_un to = {.sun_family = AF_UNIX};
	int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);

	snprintf(to.sun_path, sizeof(to.sun_path), "%.60s/OWS.control", directory);
	if (fd < 0 || connect(fd, (struct sockaddr *)&to, sizeof(to)) == 0)
		return fd < 0 ? -errno : fd;
	close(fd);
	return -errno;
}

struct ows_hello control_hello(uint32_t flags, const char *name)
{
	struct ows_hello hello = {
		.magic = OWS_HELLO_MAGIC,
		.major = OWS_LAYOUT_MAJOR,
		.minor = OWS_LAYOUT_MINOR,
		.flags = flags,
	};

	snprintf(hello.name, sizeof(hello.name), "%s", name);
	return hello;
}

static void take_fds(struct msghdr *message, int fds[3])
{
	struct cmsghdr *c = CMSG_FIRSTHDR(message);

	for (int i = 0; i < 3; i++)
		fds[i] = -1;
	if (c && c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_RIGHTS)
		memcpy(fds, CMSG_DATA(c), c->cmsg_len - CMSG_LEN(0));
}

int control_receive(int fd, struct ows_welcome *welcome, int fds[3])
{
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(3 * sizeof(int))];
	} room;
	struct iovec part = {.iov_base = welcome, .iov_len = sizeof(*welcome)};
	struct msghdr message = {.msg_iov = &part,
	                         .msg_iovlen = 1,
	                         .msg_control = &room,
	                         .msg_controllen = sizeof(room)};
	struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
	ssize_t n;

	if (poll(&poll_fd, 1, CONTROL_SCENE_MS) != 1)
		return -ETIMEDOUT;
	n = recvmsg(fd, &message, MSG_CMSG_CLOEXEC);
	if (n < 0 && errno == ECONNRESET) /* owsd has not read the hello */
		n = recvmsg(fd, &message, MSG_CMSG_CLOEXEC);
	if (n <= 0)
		return n ? -errno : -EPIPE;
	take_fds(&message, fds);
	return n == (ssize_t)sizeof(*welcome) ? 0 : -EMSGSIZE;
}

int control_join(struct control_client *client, uint32_t flags, const char *name)
{
	struct ows_hello hello = control_hello(flags, name);
	int err;

	*client = (struct control_client){.fd = control_connect(), .fds = {-1, -1, -1}};
	if (client->fd < 0)
		return client->fd;
	send(client->fd, &hello, sizeof(hello), MSG_NOSIGNAL);
	err = control_receive(client->fd, &client->welcome, client->fds);
	if (err || client->welcome.err)
		return err ? err : client->welcome.err;
	client->memory = mmap(NULL, client->welcome.size, PROT_READ | PROT_WRITE, MAP_SHARED,
	                      client->fds[0], 0);
	return client->memory == MAP_FAILED ? -errno : 0;
}

void control_leave(struct control_client *client)
{
	if (client->memory)
		munmap(client->memory, client->welcome.size);
	for (int i = 0; i < 3; i++)
		if (client->fds[i] >= 0)
			close(client->fds[i]);
	if (client->fd >= 0)
		close(client->fd);
	*client = (struct control_client){.fd = -1, .fds = {-1, -1, -1}};
}

int control_join_as(uid_t uid, const gid_t *groups, size_t group_count, uint32_t flags)
{
	struct control_client client;
	int status, result[2];
	int err = -EIO;
	pid_t pid;

	TEST_ASSERT_EQUAL(0, pipe2(result, O_CLOEXEC));
	pid = fork();
	if (pid == 0) {
		if (uid && (setgroups(group_count, groups) < 0 || setgid((gid_t)uid) < 0 ||
		            setuid(uid) < 0))
			_exit(1);
		err = control_join(&client, flags, "another");
		_exit(write(result[1], &err, sizeof(err)) != (ssize_t)sizeof(err));
	}
	close(result[1]);
	TEST_ASSERT_EQUAL(sizeof(err), read(result[0], &err, sizeof(err)));
	close(result[0]);
	TEST_ASSERT_EQUAL(pid, waitpid(pid, &status, 0));
	TEST_ASSERT_EQUAL(0, status);
	return err;
}
