/* SPDX-License-Identifier: MIT */
/*
 * The server of the owserver protocol with hostile clients, and an engine that answers as it likes.
 * The input is a list of what happens: bytes and requests of up to four clients, answers of the
 * engine, time.
 */
#include "src/public/ows.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/heap_instance.h"

static int64_t virtual_now(void);
#define ows_now virtual_now
#include "src/daemon/serve/serve.c"
#undef ows_now

#include <sys/socket.h>

#include "hal/owfs/frame.h"

#define CLIENTS 4
#define GUESTS 16
#define EVENTS_MOST 200
#define NS_MS INT64_C(1000000)

static struct fuzz fuzz;
static int64_t now_ns;
static struct serve *serve;
static struct guest {
	struct engine_guest *guest;
	bool answered; /* and still lent */
} guests[GUESTS];
static unsigned guest_count;
static struct other_side {
	int fd;
	uint8_t head[FRAME_HEADER];
	uint32_t got, left; /* of the header; of its data */
} sides[CLIENTS];

size_t fuzz_memory(size_t n)
{
	(void)n; /* what comes makes nothing grow */
	return 1000000;
}

static int64_t virtual_now(void)
{
	return now_ns;
}

static void no_ring(void *ctx)
{
	(void)ctx;
}

/* --- The server's thread, without a thread ---------------------------------------------------- */

static void turn(void)
{
	struct epoll_event events[EVENTS];

	for (int i = 0; i < 40; i++) {
		int n = epoll_wait(serve->epoll_fd, events, EVENTS, 0);

		serve->now_ns = now_ns;
		take_events(serve, events, n);
		take_answers(serve);
		serve_round(serve);
		work_queue(serve);
		if (serve->now_ns >= serve->look_ns)
			clients_look(serve);
		if (n == 0 && !serve->round_count && !work_waits(serve))
			return;
	}
}

/* --- Clients ---------------------------------------------------------------------------------- */

static void join(struct other_side *side)
{
	static const struct sockaddr_in6 nobody;
	int pair[2], small = 4096;

	TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, pair));
	setsockopt(pair[1], SOL_SOCKET, SO_SNDBUF, &small, sizeof(small));
	*side = (struct other_side){.fd = pair[0]};
	client_open(serve, pair[1], &(struct listener){0}, &nobody);
}

/* What the server sends is frames, one behind the other. */
static void check_bytes(struct other_side *side, const uint8_t *bytes, size_t n)
{
	struct frame_header h;

	for (size_t at = 0; at < n;) {
		size_t part;

		if (side->left) {
			part = n - at < side->left ? n - at : side->left;
			side->left -= (uint32_t)part;
			at += part;
			continue;
		}
		side->head[side->got++] = bytes[at++];
		if (side->got < FRAME_HEADER)
			continue;
		side->got = 0;
		frame_get_header(side->head, &h);
		TEST_ASSERT_EQUAL_HEX32_MESSAGE(0, h.version, "no frame");
		TEST_ASSERT_TRUE_MESSAGE(h.payload >= -1 && h.payload <= DIRECTORY_OUT, "no frame");
		side->left = h.payload > 0 ? (uint32_t)h.payload : 0;
	}
}

static void drain(struct other_side *side)
{
	static uint8_t bytes[65536];
	ssize_t n;

	while (side->fd >= 0 && (n = recv(side->fd, bytes, sizeof(bytes), MSG_DONTWAIT)) > 0) {
		check_bytes(side, bytes, (size_t)n);
		turn();
	}
}

static void leave(struct other_side *side)
{
	if (side->fd >= 0)
		close(side->fd);
	side->fd = -1;
}

static void send_bytes(struct other_side *side, const uint8_t *bytes, size_t n)
{
	if (side->fd >= 0 && n)
		(void)!send(side->fd, bytes, n, MSG_NOSIGNAL | MSG_DONTWAIT);
}

/* A whole request; its numbers need not fit. */
static void send_request(struct other_side *side)
{
	static const char *const paths[] = {
		"/",
		"/28.551DDF030000/temperature",
		"/signals/room",
		"/29.551DDF030000/PIO.0",
		"/bus.0/",
		"/uncached/alarm/",
		"/settings/return_codes/text.ALL",
		"/signals/",
		"/structure/28/temperature",
		"/alias/temperature",
		"/signals/label",
		"/bus.1",
		"/28.551DDF030000/",
		"/statistics/read",
		"/signals/relay",
		"/simultaneous/temperature",
	};
	static const int32_t sizes[] = {64, 65536, 100050, 0, -1, 1, 2147483647, 8192};
	static uint8_t frame[FRAME_REQUEST_MAX + 1024];
	uint8_t type = fuzz_byte(&fuzz), what = fuzz_byte(&fuzz), how = fuzz_byte(&fuzz);
	size_t n, path_len;
	struct frame_header h = {.type = type & 0x0f,
	                         .size = sizes[how & 7],
	                         .offset = how & 8 ? (int32_t)fuzz_word(&fuzz) : 0};
	const uint8_t *data;

	h.flags = (how & 0x10 ? fuzz_word(&fuzz) : 0x100) | FRAME_PERSIST;
	if (what & 0x80) {
		data = fuzz_bytes(&fuzz, 255, &path_len);
		if (path_len)
			memcpy(frame + FRAME_HEADER, data, path_len);
	} else {
		path_len = strlen(paths[what & 15]);
		memcpy(frame + FRAME_HEADER, paths[what & 15], path_len);
	}
	frame[FRAME_HEADER + path_len++] = '\0';
	data = fuzz_bytes(&fuzz, 255, &n);
	if (n)
		memcpy(frame + FRAME_HEADER + path_len, data, n);
	if (how & 0x20) { /* long */
		memset(frame + FRAME_HEADER + path_len + n, '7', 60000);
		n += 60000;
	}
	if (h.type == FRAME_WRITE && !(how & 0x40))
		h.size = (int32_t)n;
	h.payload = (int32_t)(path_len + n);
	frame_put_header(frame, &h);
	send_bytes(side, frame, FRAME_HEADER + (size_t)h.payload - (how & 0x80 ? n / 2 : 0));
}

/* --- The engine ------------------------------------------------------------------------------- */

static void take_guests(void)
{
	const struct engine_guests *port = serve_guests(serve);
	struct engine_guest *guest;

	while (guest_count < GUESTS && (guest = port->take(port->ctx)) != NULL) {
		for (unsigned i = 0; i < guest_count; i++)
			TEST_ASSERT_TRUE_MESSAGE(guests[i].guest != guest,
			                         "asked again while lent");
		TEST_ASSERT_NOT_NULL(memchr(guest->path, '\0', NODE_PATH_MAX + 16));
		TEST_ASSERT_TRUE(guest->lane == GUEST_ANY_LANE ||
		                 (guest->lane >= 0 && guest->lane < 2));
		guests[guest_count++] = (struct guest){.guest = guest};
	}
}

/* Text of a bus into the room; a list has whole lines. */
static void fill(struct engine_guest *g)
{
	size_t n;
	const uint8_t *text = fuzz_bytes(&fuzz, 255, &n);
	bool list = g->op == BUS_DIR;

	if (n > g->len)
		n = g->len;
	if (n)
		memcpy(g->data, text, n);
	for (size_t i = 0; list && i < n; i++)
		if (!g->data[i] || i + 1 == n)
			g->data[i] = '\n';
	g->answer.len = (uint32_t)n;
}

static void answer_one(void)
{
	static const int errors[] = {
		0,          0,         0,        -ENODEV,    -ENOENT,      -EISDIR,
		-EACCES,    -EIO,      -ENOTDIR, -ENOTCONN,  -EINPROGRESS, -EINVAL,
		-ETIMEDOUT, -EMSGSIZE, -EBUSY,   -EOPNOTSUPP};
	const struct engine_guests *port = serve_guests(serve);
	uint8_t what = fuzz_byte(&fuzz);
	struct engine_guest *g;
	unsigned at;

	take_guests();
	if (!guest_count)
		return;
	at = (what >> 4 & 7) % guest_count;
	g = guests[at].guest;
	if (guests[at].answered) {
		/* what is still lent is still written to */
		if (g->data && g->len && g->op != BUS_WRITE)
			memset(g->data, 'x', g->len);
		guests[at] = guests[--guest_count];
		port->released(port->ctx, g);
		return;
	}
	g->answer = (struct bus_answer){.err = errors[what & 15], .measured_ns = now_ns};
	g->served = what >> 4 & 1;
	g->generation = heap.image.header->generation;
	g->lent = (what & 0x80) && g->answer.err;
	if (!g->answer.err && (g->op == BUS_READ || g->op == BUS_DIR))
		fill(g);
	if (g->lent)
		guests[at].answered = true;
	else
		guests[at] = guests[--guest_count];
	port->answered(port->ctx, g);
}

static void publish(void)
{
	uint8_t what = fuzz_byte(&fuzz);
	uint32_t record = 1 + what % HEAP_SIGNALS;

	heap_beat(now_ns);
	heap_put(record, heap_signals[record - 1].type == OWS_BOOL ? 1 : fuzz_word(&fuzz), "more",
	         now_ns, what >> 4);
}

static void happen(void)
{
	static const int64_t spans[] = {NS_MS,         20 * NS_MS,    1100 * NS_MS,   3000 * NS_MS,
	                                11000 * NS_MS, 61000 * NS_MS, 601000 * NS_MS, 100 * NS_MS};
	uint8_t what = fuzz_byte(&fuzz);
	struct other_side *side = &sides[what >> 6];
	const uint8_t *bytes;
	size_t n;

	if (side->fd < 0)
		join(side);
	switch (what & 7) {
	case 0:
		bytes = fuzz_bytes(&fuzz, 255, &n);
		send_bytes(side, bytes, n);
		break;
	case 1:
	case 2:
		send_request(side);
		break;
	case 3:
	case 4:
		answer_one();
		break;
	case 5:
		now_ns += spans[what >> 3 & 7];
		break;
	case 6:
		if (what & 0x10)
			leave(side);
		else if (what & 0x20)
			shutdown(side->fd, SHUT_WR);
		else
			publish();
		break;
	case 7:
		drain(side);
		break;
	}
	turn();
}

static void begin(void)
{
	static struct config_item items[HEAP_SIGNALS];
	static struct config_target targets[] = {{.text = "null:"}, {.text = "w1"}};
	static const struct config config = {
		.targets = targets, .target_count = 2, .items = items, .item_count = HEAP_SIGNALS};
	struct serve_setup setup = {
		.config = &config, .instance = "OWS", .dir = "/", .directory = -1, .ring = no_ring};
	char why[128];

	for (unsigned i = 0; i < HEAP_SIGNALS; i++)
		items[i] = (struct config_item){.name = heap_signals[i].name,
		                                .path = heap_signals[i].path,
		                                .type = (enum ows_type)heap_signals[i].type,
		                                .output = i == 1 || i == 3 || i == 4};
	now_ns = HEAP_START;
	heap_instance_reset();
	TEST_ASSERT_EQUAL_INT(0, serve_create(&setup, &serve, why, sizeof(why)));
	serve->image = &heap.image;
	serve->now_ns = now_ns;
	serve->look_ns = INT64_MAX;
	serve->kept = kept_create(&config);
	TEST_ASSERT_NOT_NULL(serve->kept);
	TEST_ASSERT_EQUAL_INT(0, signals_open("/", "OWS", &serve->signals));
	guest_count = 0;
	for (int i = 0; i < CLIENTS; i++)
		sides[i].fd = -1;
}

/* All that is out comes back, and then nothing is left of anybody. */
static void end(void)
{
	fuzz.at = fuzz.end;
	for (int i = 0; i < CLIENTS; i++)
		leave(&sides[i]);
	turn();
	for (take_guests(); guest_count; take_guests()) {
		answer_one();
		turn();
	}
	turn();
	TEST_ASSERT_EQUAL_UINT_MESSAGE(SERVER_CLIENTS, serve->free_count,
	                               "a client stays for ever");
	TEST_ASSERT_EQUAL_UINT64(0, serve->counters[COUNT_clients].value);
	TEST_ASSERT_EQUAL_UINT(0, serve->queued);
	for (int i = 0; i < SERVER_DIRECTORIES; i++)
		TEST_ASSERT_FALSE_MESSAGE(serve->directories[i].used, "a directory stays for ever");
	serve_destroy(serve);
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	fuzz = (struct fuzz){bytes, bytes + n};
	begin();
	for (int i = 0; i < EVENTS_MOST && fuzz_left(&fuzz); i++)
		happen();
	end();
}
