/* SPDX-License-Identifier: MIT */
/*
 * The control socket, from both ends. The first byte says which: even, hostile programs connect to
 * the control room, and say, send and close what they like, while controllers come and go and owsd
 * reloads; odd, an owsd that sends any bytes and any descriptors welcomes libows. Nothing is read
 * or written outside of the memories, and no descriptor is left over.
 */
#include <dirent.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include "src/memory/control/control.c"

#include "src/memory/libows/give.h"
#include "src/memory/libows/join.h"
#include "tests/fuzz/fuzz.h"

#define STEPS 96
#define CLIENTS 24
#define SIGNALS 40

static struct fuzz fuzz;
static struct control *room;
static struct controller_layout layouts[2];
static unsigned generation;
static int64_t now_ns;
static int clients[CLIENTS]; /* -1: not connected */
static unsigned inside;      /* controllers that the engine has */

static struct config_item items[SIGNALS];
static struct config config = {.items = items, .item_count = SIGNALS};

size_t fuzz_memory(size_t n)
{
	(void)n;
	return 4000000;
}

static unsigned descriptors(void)
{
	DIR *folder = opendir("/proc/self/fd");
	unsigned n = 0;

	TEST_ASSERT_NOT_NULL(folder);
	while (readdir(folder))
		n++;
	closedir(folder);
	return n;
}

/* --- The room -------------------------------------------------------------------------------- */

static void ring(void *ctx)
{
	(void)ctx;
}

static const struct controller_layout *make_layout(void)
{
	static uint8_t types[SIGNALS];
	const struct controller_plan plan = {.types = types,
	                                     .signal_count = SIGNALS,
	                                     .text_cap = 64,
	                                     .generation = generation + 1,
	                                     .start_id = generation + 1};
	struct controller_layout *layout = &layouts[++generation % 2];

	for (unsigned i = 0; i < SIGNALS; i++)
		types[i] = i % 7 ? OWS_BYTE : OWS_STRING;
	controller_layout_free(layout);
	TEST_ASSERT_EQUAL_INT(0, controller_layout_make(layout, &plan));
	return layout;
}

/* A round of the room's thread. */
static void turn_room(void)
{
	struct epoll_event events[EVENTS];
	int n = epoll_wait(room->epoll, events, EVENTS, 0);

	room->now_ns = now_ns;
	for (int i = 0; i < n; i++)
		take_event(room, events[i].data.u32);
	if (room->accepts && room->now_ns >= room->accept_ns)
		door_accept(room);
	door_look(room);
}

/* Look at a memory as the engine does. */
static void look_at(const struct controller_memory *memory)
{
	char text[65], name[OWS_NAME];
	struct controller_command command;
	struct controller_shelf shelf;
	struct controller_beat beat;
	int from = 0;

	controller_marked(memory);
	for (int i = 0; i < 8 && (from = controller_next_dirty(memory, (uint32_t)from)) >= 0; i++) {
		controller_load(memory, (uint32_t)from, &command);
		TEST_ASSERT_TRUE(command.person <= OWS_PERSONS);
		controller_person(memory, command.person, name);
		TEST_ASSERT_NOT_NULL(memchr(name, '\0', sizeof(name)));
		if (memory->layout->places[from] != CONTROLLER_NO_TEXT)
			TEST_ASSERT_TRUE(controller_text(memory, (uint32_t)from, text) <= 64);
		controller_taken(memory, (uint32_t)from, command.stamp, 0);
	}
	controller_shelf(memory, &shelf);
	TEST_ASSERT_TRUE(shelf.record <= SIGNALS);
	controller_shelf_done(memory, shelf.count, 0);
	controller_beat(memory, &beat);
}

static void turn_engine(unsigned most)
{
	struct control_message message;

	while (most-- && control_next(room, &message)) {
		TEST_ASSERT_NOT_NULL(message.controller.memory.base);
		TEST_ASSERT_NOT_NULL(memchr(message.controller.who.name, '\0', OWS_NAME));
		TEST_ASSERT_NOT_EQUAL(0, message.controller.who.serial);
		TEST_ASSERT_EQUAL_UINT(getuid(), message.controller.who.uid);
		look_at(&message.controller.memory);
		inside += message.joins ? 1u : -1u;
		control_done(room, &message);
	}
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		if (room->engine.memories[i].base)
			look_at(&room->engine.memories[i]);
}

static void reload(void)
{
	struct control_message message;
	unsigned seat = 0, prepared = 0;

	control_asked(room);
	control_take_askers(room);
	control_prepare(room, &config, make_layout());
	turn_engine(OWS_CONTROLLERS + 1);
	for (; control_prepared(room, &seat, &message); prepared++)
		TEST_ASSERT_EQUAL_PTR(&layouts[generation % 2], message.controller.memory.layout);
	TEST_ASSERT_TRUE(prepared <= inside);
	control_reloaded(room);
	control_answer(room, 0, "");
}

static void check_room(void)
{
	unsigned connections = 0;

	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		connections += room->seats[i].state != CONTROL_FREE;
	TEST_ASSERT_EQUAL_UINT(connections,
	                       (unsigned)bus_counted(&room->counters[CONTROL_connections]));
	TEST_ASSERT_TRUE(inside <= connections);
}

/* --- Programs -------------------------------------------------------------------------------- */

static int connect_to(int directory)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);

	TEST_ASSERT_TRUE(fd >= 0);
	snprintf(address.sun_path, sizeof(address.sun_path), "/proc/self/fd/%d/OWS.control",
	         directory);
	if (connect(fd, (const void *)&address, sizeof(address)) == 0)
		return fd;
	close(fd);
	return -1;
}

static void close_client(int *fd)
{
	if (*fd >= 0)
		close(*fd);
	*fd = -1;
}

static void send_with(int to, const void *bytes, size_t n, const int *fds, size_t count)
{
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(8 * sizeof(int))];
	} space = {{0}};
	struct iovec part = {.iov_base = (void *)(uintptr_t)bytes, .iov_len = n};
	struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
	struct cmsghdr *c;

	if (count) {
		message.msg_control = &space;
		message.msg_controllen = CMSG_SPACE(count * sizeof(int));
		c = CMSG_FIRSTHDR(&message);
		c->cmsg_level = SOL_SOCKET;
		c->cmsg_type = SCM_RIGHTS;
		c->cmsg_len = CMSG_LEN(count * sizeof(int));
		memcpy(CMSG_DATA(c), fds, count * sizeof(int));
	}
	sendmsg(to, &message, MSG_DONTWAIT | MSG_NOSIGNAL);
}

static void overlay(void *on, size_t size)
{
	size_t n, off = fuzz_byte(&fuzz) % size;
	const uint8_t *bytes = fuzz_bytes(&fuzz, 64, &n);

	if (n)
		memcpy((char *)on + off, bytes, n < size - off ? n : size - off);
}

static void say_hello(int to, uint8_t how)
{
	struct ows_hello hello = {.magic = OWS_HELLO_MAGIC,
	                          .major = OWS_LAYOUT_MAJOR,
	                          .flags = (how & 1 ? OWS_HELLO_COMMAND : 0) |
	                                   (how & 4 ? OWS_HELLO_RELOAD : 0),
	                          .name = "fuzz"};
	const int fds[] = {to, room->epoll};

	overlay(&hello, sizeof(hello));
	send_with(to, &hello, sizeof(hello), fds, how & 2 ? 2 : 0);
}

/* A controller writes anything anywhere. */
static void scribble(int memory, size_t size)
{
	char *base = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, memory, 0);

	TEST_ASSERT_TRUE(base != MAP_FAILED);
	for (int i = fuzz_byte(&fuzz) & 7; i; i--) {
		uint32_t off = fuzz_word(&fuzz) % (uint32_t)size;
		size_t n;
		const uint8_t *bytes = fuzz_bytes(&fuzz, 64, &n);

		if (n)
			memcpy(base + off, bytes, n < size - off ? n : size - off);
	}
	memset(base + layouts[generation % 2].header.dirty_off, 0xff, 4);
	munmap(base, size);
}

static void receive(int from, bool writes)
{
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(3 * sizeof(int))];
	} space = {{0}};
	struct ows_welcome welcome = {0};
	struct iovec part = {.iov_base = &welcome, .iov_len = sizeof(welcome)};
	struct msghdr message = {.msg_iov = &part,
	                         .msg_iovlen = 1,
	                         .msg_control = &space,
	                         .msg_controllen = sizeof(space)};
	const struct cmsghdr *c;
	int fds[3];

	if (recvmsg(from, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC) <= 0)
		return;
	TEST_ASSERT_EQUAL_HEX32(OWS_WELCOME_MAGIC, welcome.magic);
	c = CMSG_FIRSTHDR(&message);
	TEST_ASSERT_EQUAL_MESSAGE(welcome.err == 0 && welcome.size, c != NULL, "descriptors");
	if (!c)
		return;
	memcpy(fds, CMSG_DATA(c), c->cmsg_len - CMSG_LEN(0));
	TEST_ASSERT_EQUAL(-1, ftruncate(fds[0], 0));
	if (writes)
		scribble(fds[0], welcome.size);
	for (size_t i = 0; i < (c->cmsg_len - CMSG_LEN(0)) / sizeof(int); i++)
		close(fds[i]);
}

static void happen(int directory)
{
	uint8_t what = fuzz_byte(&fuzz), which = fuzz_byte(&fuzz);
	int *client = &clients[which % CLIENTS];
	const uint8_t *bytes;
	size_t n;

	switch (what & 7) {
	case 0:
		if (*client < 0)
			*client = connect_to(directory);
		break;
	case 1:
		bytes = fuzz_bytes(&fuzz, 255, &n);
		send_with(*client, bytes, n, client, what >> 3 & 1);
		break;
	case 2:
		say_hello(*client, what >> 3);
		break;
	case 3:
		if (what & 8)
			shutdown(*client, what >> 4 & 1);
		else
			close_client(client);
		break;
	case 4:
		receive(*client, what & 8);
		break;
	case 5:
		turn_engine(which & 7);
		control_news(room, NULL);
		break;
	case 6:
		now_ns += what >> 3 & 1 ? which * 10 * NS_PER_MS : 0;
		turn_room();
		break;
	case 7:
		if (what & 8)
			reload();
		turn_room();
		break;
	}
	check_room();
}

static char folder[] = "/tmp/owsd-fuzz-XXXXXX";

static void remove_folder(void)
{
	rmdir(folder);
}

static void crowd(void)
{
	static int directory = -1;
	struct control_setup setup = {.config = &config, .instance = "OWS", .ring = ring};
	char why[200] = "";

	if (directory < 0) {
		TEST_ASSERT_NOT_NULL(mkdtemp(folder));
		directory = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
		atexit(remove_folder);
	}
	setup.directory = directory;
	for (unsigned i = 0; i < SIGNALS; i++)
		items[i] = (struct config_item){.name = i % 3 ? "pump" : "valve",
		                                .type = i % 7 ? OWS_BYTE : OWS_STRING};
	for (unsigned i = 0; i < CLIENTS; i++)
		clients[i] = -1;
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, control_create(&setup, &room, why, sizeof(why)), why);
	room->layout = make_layout();
	now_ns = 1000 * NS_PER_S;
	inside = 0;
	for (int i = 0; i < STEPS && fuzz_left(&fuzz); i++)
		happen(directory);
	for (unsigned i = 0; i < CLIENTS; i++)
		close_client(&clients[i]);
	for (int i = 0; i < 3; i++) {
		turn_room();
		turn_engine(OWS_CONTROLLERS);
	}
	turn_room();
	TEST_ASSERT_EQUAL_UINT(0, inside);
	TEST_ASSERT_EQUAL_UINT64(0, bus_counted(&room->counters[CONTROL_connections]));
	control_stop(room);
	control_destroy(room);
	controller_layout_free(&layouts[0]);
	controller_layout_free(&layouts[1]);
}

/* --- A hostile owsd -------------------------------------------------------------------------- */

static int make_memory(uint8_t how, size_t size)
{
	int fd = memfd_create("fuzz", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	struct ows_controller_header h = {.magic = OWS_CONTROLLER_MAGIC,
	                                  .major = OWS_LAYOUT_MAJOR,
	                                  .size = (uint32_t)size,
	                                  .slot_off = 256,
	                                  .slot_size = 64,
	                                  .slot_count = 3,
	                                  .text_off = 1280,
	                                  .text_cap = 64,
	                                  .place_off = 512,
	                                  .dirty_off = 528,
	                                  .dirty_words = 1,
	                                  .person_off = 576,
	                                  .shelf_off = 1152,
	                                  .state = OWS_STATE_LIVE};

	TEST_ASSERT_TRUE(fd >= 0);
	overlay(&h, sizeof(h));
	TEST_ASSERT_EQUAL(0, ftruncate(fd, (off_t)size));
	TEST_ASSERT_TRUE(pwrite(fd, &h, sizeof(h), 0) >= 0);
	if (how & 1)
		fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL);
	return fd;
}

/* What libows does with a memory that it has taken for right. */
static void use(const struct give *give)
{
	for (uint32_t i = 0; i < give->header.slot_count && i < 4096; i++) {
		struct ows_command_text *text = give_text(give, i);

		give_slot(give, i)->stamp++;
		give_mark(give, i);
		if (text)
			give_store_text(text, "text",
			                give->header.text_cap < 4 ? give->header.text_cap : 4);
	}
	give_store_name(give_person(give, OWS_PERSONS - 1), "somebody", OWS_NAME);
	give_store_name(give_shelf(give)->why, "why", OWS_TEXT);
}

static void welcome_one(struct join *join, int owsd)
{
	struct ows_welcome welcome = {.magic = OWS_WELCOME_MAGIC, .major = OWS_LAYOUT_MAJOR};
	uint8_t how = fuzz_byte(&fuzz);
	size_t size = 1536 + (size_t)(how >> 5) * 512, count = how >> 1 & 7;
	struct give give;
	int fds[7], memory, err;

	for (size_t i = 0; i < count; i++)
		fds[i] = make_memory(how, size);
	welcome.size = (uint32_t)size;
	overlay(&welcome, sizeof(welcome));
	send_with(owsd, &welcome, fuzz_byte(&fuzz) & 0x80 ? 40 : sizeof(welcome), fds, count);
	for (size_t i = 0; i < count; i++)
		close(fds[i]);
	err = join_receive(join, 0, &welcome, &memory);
	TEST_ASSERT_TRUE(err <= 0);
	TEST_ASSERT_EQUAL(err == 0, memory >= 0);
	if (err)
		return;
	TEST_ASSERT_TRUE(join->bell >= 0 && join->news >= 0);
	if (give_map(memory, &welcome, &give) == 0) {
		use(&give);
		give_unmap(&give);
	}
	close(memory);
}

static void owsd_is_hostile(void)
{
	struct join join;
	int ends[2];

	TEST_ASSERT_EQUAL(0, socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends));
	join_none(&join);
	join.connection = ends[0];
	join.new = true;
	for (int i = 0; i < 16 && join.connection >= 0 && fuzz_left(&fuzz); i++)
		welcome_one(&join, ends[1]);
	join_end(&join);
	close(ends[1]);
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	unsigned before = descriptors();
	uint8_t how;

	fuzz = (struct fuzz){bytes, bytes + n};
	how = fuzz_byte(&fuzz);
	if (how & 1)
		owsd_is_hostile();
	else
		crowd();
	TEST_ASSERT_TRUE_MESSAGE(descriptors() <= before + 1, "descriptors are left over");
}
