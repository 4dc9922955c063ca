/* SPDX-License-Identifier: MIT */
/* The control socket of an instance without owsd: welcomes whoever connects, and can lie. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "unity.h"

#include "tests/unit/aid/door.h"

#define PATIENCE_MS 60000
#define SEALS (F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL)

static void make_layout(struct door *door, uint32_t generation, uint32_t start_id,
                        const uint8_t *types, uint32_t count, uint16_t text_cap)
{
	const struct controller_plan plan = {
		.types = types,
		.signal_count = count,
		.text_cap = text_cap,
		.generation = generation,
		.start_id = start_id,
	};

	TEST_ASSERT_EQUAL(0, controller_layout_make(&door->layout, &plan));
}

/* In the door's thread: what Unity counts is of the test's thread alone. */
static void must(bool held)
{
	if (!held)
		abort();
}

/* Make the memory of a controller; a lie may be in it. */
static void make_memory(struct door *door, struct door_controller *controller, uint32_t serial)
{
	size_t size = door->layout.header.size;
	struct ows_controller_header *header;
	int fd = memfd_create("door", MFD_CLOEXEC | MFD_ALLOW_SEALING);

	must(fd >= 0);
	must(ftruncate(fd, (off_t)size) == 0);
	header = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
	must(header != MAP_FAILED);
	controller->memory_fd = fd;
	controller->memory = (struct controller_memory){.base = (char *)header,
	                                                .layout = &door->layout};
	controller_build(&controller->memory, serial);
	for (uint32_t i = 0; i < door->layout.header.slot_count; i++)
		controller_allow(&controller->memory, i, true);
	controller_state(&controller->memory, OWS_STATE_LIVE);
	if (door->lie == DOOR_OTHER_MEMORY)
		header->magic = OWS_IMAGE_MAGIC;
	if (door->lie == DOOR_OUTSIDE)
		header->slot_off = 0x7ffffff8;
	if (door->lie == DOOR_SMALL)
		must(ftruncate(fd, 128) == 0);
	if (door->lie != DOOR_NO_SEALS)
		must(fcntl(fd, F_ADD_SEALS, SEALS) == 0);
}

static size_t fill_welcome(const struct door *door, uint32_t serial, struct ows_welcome *welcome)
{
	size_t size = door->layout.header.size;

	*welcome = (struct ows_welcome){
		.magic = door->lie == DOOR_OTHER_MAGIC ? 1 : OWS_WELCOME_MAGIC,
		.major = door->lie == DOOR_OTHER_MAJOR ? OWS_LAYOUT_MAJOR + 1 : OWS_LAYOUT_MAJOR,
		.generation = door->layout.header.generation,
		.start_id = door->layout.header.start_id,
		.serial = serial,
		.size = (uint32_t)(door->lie == DOOR_OTHER_SIZE ? 2 * size
	                           : door->lie == DOOR_SMALL    ? 128
	                                                        : size),
	};
	if (door->lie == DOOR_REFUSES)
		welcome->err = -EACCES;
	if (door->lie == DOOR_OTHER_START)
		welcome->start_id++;
	snprintf((char *)welcome->token, sizeof(welcome->token), "token %u", (unsigned)serial);
	return door->lie == DOOR_SHORT ? sizeof(*welcome) / 2 : sizeof(*welcome);
}

static void send_welcome(const struct door *door, const struct door_controller *controller,
                         uint32_t serial, unsigned fd_count)
{
	union {
		struct cmsghdr header;
		char room[CMSG_SPACE(8 * sizeof(int))];
	} control = {0};
	int fds[8] = {controller->memory_fd, controller->bell, controller->news, controller->bell,
	              controller->bell,      controller->bell, controller->bell, controller->bell};
	struct ows_welcome welcome;
	struct iovec data = {.iov_base = &welcome, .iov_len = fill_welcome(door, serial, &welcome)};
	struct msghdr message = {.msg_iov = &data, .msg_iovlen = 1};

	if (fd_count > 0) {
		message.msg_control = control.room;
		message.msg_controllen = CMSG_SPACE(fd_count * sizeof(int));
		control.header = (struct cmsghdr){
			.cmsg_level = SOL_SOCKET,
			.cmsg_type = SCM_RIGHTS,
			.cmsg_len = CMSG_LEN(fd_count * sizeof(int)),
		};
		memcpy(CMSG_DATA(&control.header), fds, fd_count * sizeof(int));
	}
	sendmsg(controller->connection, &message, MSG_NOSIGNAL);
}

static unsigned fds_of(enum door_lie lie)
{
	switch (lie) {
	case DOOR_NO_FDS:
	case DOOR_REFUSES:
		return 0;
	case DOOR_ONE_FD:
		return 1;
	case DOOR_MANY_FDS:
		return 8;
	default:
		return 3;
	}
}

static void hang_up(struct door_controller *controller)
{
	if (controller->gone)
		return;
	controller->gone = true;
	close(controller->connection);
}

static void welcome_one(struct door *door)
{
	struct pollfd hello = {.fd = accept4(door->listener, NULL, NULL, SOCK_CLOEXEC),
	                       .events = POLLIN};
	struct door_controller *controller = &door->controllers[door->count];

	if (hello.fd < 0)
		return;
	if (door->count == DOOR_CONTROLLERS || poll(&hello, 1, PATIENCE_MS) != 1) {
		close(hello.fd);
		return;
	}
	*controller = (struct door_controller){
		.connection = hello.fd,
		.bell = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC),
		.news = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC),
	};
	recv(hello.fd, &controller->hello, sizeof(controller->hello), 0);
	make_memory(door, controller, door->count + 1);
	door->count++;
	if (door->lie == DOOR_HANGS_UP)
		hang_up(controller);
	else if (door->lie != DOOR_SILENT)
		send_welcome(door, controller, door->count, fds_of(door->lie));
}

static void *keep_door(void *arg)
{
	struct door *door = arg;
	struct pollfd fds[DOOR_CONTROLLERS + 2];

	pthread_mutex_lock(&door->lock);
	while (!door->stop) {
		unsigned n = 2;

		fds[0] = (struct pollfd){.fd = door->listener, .events = POLLIN};
		fds[1] = (struct pollfd){.fd = door->wake, .events = POLLIN};
		for (unsigned i = 0; i < door->count; i++)
			fds[n++] = (struct pollfd){
				.fd = door->controllers[i].gone ? -1
			                                        : door->controllers[i].connection,
				.events = POLLIN,
			};
		pthread_mutex_unlock(&door->lock);
		poll(fds, n, -1);
		pthread_mutex_lock(&door->lock);
		for (unsigned i = 2; i < n; i++)
			if (fds[i].revents && !door->stop)
				hang_up(&door->controllers[i - 2]);
		if (fds[0].revents && !door->stop)
			welcome_one(door);
	}
	pthread_mutex_unlock(&door->lock);
	return NULL;
}

void door_open(struct door *door, const char *instance, uint32_t generation, uint32_t start_id,
               const uint8_t *types, uint32_t count, uint16_t text_cap)
{
	struct sockaddr_un to = {.sun_family = AF_UNIX};

	*door = (struct door){.lock = PTHREAD_MUTEX_INITIALIZER};
	make_layout(door, generation, start_id, types, count, text_cap);
	TEST_ASSERT_EQUAL(0, dir_make(&door->dir));
	snprintf(door->file, sizeof(door->file), "%s.control", instance);
	unlinkat(door->dir.fd, door->file, 0);
	snprintf(to.sun_path, sizeof(to.sun_path), "/proc/self/fd/%d/%s", door->dir.fd, door->file);
	door->listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	TEST_ASSERT_EQUAL(0, bind(door->listener, (struct sockaddr *)&to, sizeof(to)));
	TEST_ASSERT_EQUAL(0, listen(door->listener, DOOR_CONTROLLERS));
	door->wake = eventfd(0, EFD_CLOEXEC);
	TEST_ASSERT_EQUAL(0, pthread_create(&door->thread, NULL, keep_door, door));
}

void door_close(struct door *door)
{
	const uint64_t one = 1;
	bool woken;
	int err;

	pthread_mutex_lock(&door->lock);
	door->stop = true;
	pthread_mutex_unlock(&door->lock);
	woken = write(door->wake, &one, sizeof(one)) == sizeof(one);
	err = woken ? 0 : errno;
	if (woken)
		err = pthread_join(door->thread, NULL);
	close(door->listener);
	close(door->wake);
	for (unsigned i = 0; i < door->count; i++) {
		struct door_controller *controller = &door->controllers[i];

		hang_up(controller);
		munmap(controller->memory.base, door->layout.header.size);
		close(controller->memory_fd);
		close(controller->bell);
		close(controller->news);
	}
	unlinkat(door->dir.fd, door->file, 0);
	dir_close(&door->dir);
	controller_layout_free(&door->layout);
	TEST_ASSERT_TRUE_MESSAGE(woken, strerror(err));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, err, strerror(err));
}

void door_reload(struct door *door, uint32_t generation, uint32_t start_id, const uint8_t *types,
                 uint32_t count, uint16_t text_cap, const uint32_t *rows)
{
	struct controller_layout before;

	pthread_mutex_lock(&door->lock);
	before = door->layout;
	make_layout(door, generation, start_id, types, count, text_cap);
	for (unsigned i = 0; i < door->count; i++) {
		struct door_controller *controller = &door->controllers[i];
		struct controller_memory old = controller->memory;

		old.layout = &before;
		controller_state(&old, OWS_STATE_RETIRED);
		close(controller->memory_fd);
		make_memory(door, controller, i + 1);
		controller_copy(&controller->memory, &old, rows);
		munmap(old.base, before.header.size);
		if (!controller->gone && door->lie != DOOR_LOSES)
			send_welcome(door, controller, i + 1, 1);
	}
	controller_layout_free(&before);
	pthread_mutex_unlock(&door->lock);
}

void door_lie(struct door *door, enum door_lie lie)
{
	pthread_mutex_lock(&door->lock);
	door->lie = lie;
	pthread_mutex_unlock(&door->lock);
}

struct door_controller *door_controller(struct door *door, unsigned i)
{
	pthread_mutex_lock(&door->lock);
	TEST_ASSERT_LESS_THAN_MESSAGE(door->count, i, "nobody came so far");
	pthread_mutex_unlock(&door->lock);
	return &door->controllers[i];
}

unsigned door_count(struct door *door)
{
	unsigned count;

	pthread_mutex_lock(&door->lock);
	count = door->count;
	pthread_mutex_unlock(&door->lock);
	return count;
}

void door_wait_gone(struct door *door, unsigned i)
{
	struct door_controller *controller = door_controller(door, i);
	const struct timespec pause = {.tv_nsec = 1000000};
	bool gone = false;

	for (int n = 0; !gone && n < PATIENCE_MS; n++) {
		nanosleep(&pause, NULL); /* pace */
		pthread_mutex_lock(&door->lock);
		gone = controller->gone;
		pthread_mutex_unlock(&door->lock);
	}
	TEST_ASSERT_TRUE_MESSAGE(gone, "the controller did not hang up");
}

uint64_t door_rings(struct door *door, unsigned i)
{
	uint64_t rings = 0;

	return read(door_controller(door, i)->bell, &rings, sizeof(rings)) < 0 ? 0 : rings;
}
