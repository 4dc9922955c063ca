/* SPDX-License-Identifier: MIT */
/* Connections: bytes in, bytes out, time limits. This file does not know what a request means. */
#include <errno.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/owfs/frame.h"
#include "src/daemon/serve/client.h"
#include "src/daemon/serve/directory.h"
#include "src/memory/shm/peer.h"
#include "src/memory/shm/porter.h"

#define FIRST_READ AREA_ANSWER

static const uint8_t alive_frame[FRAME_HEADER] = {[4] = 0xff, 0xff, 0xff, 0xff};

static unsigned index_of(const struct serve *s, const struct client *c)
{
	return (unsigned)(c - s->clients);
}

/* Give the client a turn in the round. */
static void client_ready(struct serve *s, struct client *c)
{
	if (c->queued)
		return;
	c->queued = true;
	s->round[(s->round_at + s->round_count++) % SERVER_CLIENTS] = (uint16_t)index_of(s, c);
}

static int64_t limit_of(const struct client *c)
{
	switch ((enum client_state)c->state) {
	case CLIENT_FREE:
	case CLIENT_LEFT:
		return INT64_MAX;
	case CLIENT_READING:
		return c->since_ns + (c->have > c->past || !c->served ? REQUEST_NS : IDLE_NS);
	case CLIENT_WORKING:
	case CLIENT_QUEUED:
	case CLIENT_APPLYING:
		return c->tick_ns + KEEPALIVE_NS;
	case CLIENT_SENDING:
		return c->tick_ns + SEND_NS < c->since_ns + ANSWER_NS ? c->tick_ns + SEND_NS
		                                                      : c->since_ns + ANSWER_NS;
	}
	return INT64_MAX;
}

void client_enter(struct serve *s, struct client *c, enum client_state state)
{
	c->state = (uint8_t)state;
	c->since_ns = c->tick_ns = s->now_ns;
	s->look_ns = earlier_ns(s->look_ns, limit_of(c));
}

void client_open(struct serve *s, int fd, const struct listener *from,
                 const struct sockaddr_in6 *peer)
{
	unsigned index = s->free[s->free_count - 1];
	struct client *c = &s->clients[index];
	bool queued = c->queued;

	s->free_count--;
	if (index >= s->used)
		s->used = index + 1;
	memset(c, 0, offsetof(struct client, request));
	c->queued = queued;
	c->fd = fd;
	c->network = from->network;
	c->own = from->own;
	c->peer = *peer;
	c->readable = true;
	c->came_ns = from->came_ns;
	c->need = FRAME_HEADER;
	c->area = s->areas + (size_t)index * AREA_SIZE;
	c->out_len = c->out_at = 0;
	c->directory = NULL;
	c->active_ns = s->now_ns;
	client_enter(s, c, CLIENT_READING);
	count(s, COUNT_clients, 1);
	client_ready(s, c);
}

static void put_free(struct serve *s, struct client *c)
{
	c->state = CLIENT_FREE;
	s->free[s->free_count++] = (uint16_t)index_of(s, c);
	accept_again(s);
}

static void release_directory(struct client *c)
{
	if (c->directory)
		directory_release(c->directory);
	c->directory = NULL;
}

void clients_away(struct serve *s)
{
	while (s->away_count) {
		struct porter_order order = {.what = PORTER_EACH | PORTER_HANG_UP,
		                             .slot = PORTER_NO_SLOT};

		order.count = s->away_count < PORTER_FDS ? s->away_count : PORTER_FDS;
		memcpy(order.fds, s->away + s->away_count - order.count,
		       order.count * sizeof(*s->away));
		if (porter_give(s->porter, PORTER_SERVED, &order))
			return;
		s->away_count -= order.count;
	}
}

void client_part(struct serve *s, int fd, bool network)
{
	if (network)
		close(fd);
	else
		s->away[s->away_count++] = fd;
}

/* To end a connection whose peer makes that slow is the porter's, too, as far as there is room. */
static bool may_close_here(const struct serve *s, const struct client *c)
{
	return c->network && (!c->budget.over || s->away_count >= SERVER_CLIENTS);
}

static void client_close(struct serve *s, struct client *c)
{
	bool engine_has_it = c->state == CLIENT_WORKING || c->lent;

	if (c->fd < 0)
		return;
	/* while a porter that begins has it too, closing it does not take it out */
	if (c->watched)
		epoll_ctl(s->epoll_fd, EPOLL_CTL_DEL, c->fd, NULL);
	client_part(s, c->fd, may_close_here(s, c));
	c->fd = -1;
	accept_again(s);
	count(s, COUNT_clients, (uint64_t)-1);
	if (c->state == CLIENT_QUEUED)
		s->queued--;
	if (!engine_has_it)
		release_directory(c);
	/* The engine drops a read that nobody waits for; it still carries out a write. */
	if (engine_has_it) {
		__atomic_store_n(&c->guest.unwanted, 1, __ATOMIC_RELAXED);
		c->state = CLIENT_LEFT;
	} else {
		put_free(s, c);
	}
}

void client_refused(struct serve *s, enum serve_counter what, struct log_rate *rate,
                    const char *reason)
{
	char others[LOG_OTHERS];
	uint64_t n;

	count(s, what, 1);
	n = log_rate(rate, s->now_ns);
	if (n)
		log_warning(s->log, "a client of the owserver protocol was refused: %s%s", reason,
		            log_others(n, others));
}

void client_watch(struct serve *s, struct client *c)
{
	struct epoll_event event = {.events = EPOLLIN | EPOLLOUT | EPOLLRDHUP | EPOLLET};

	if (c->watched || c->fd < 0)
		return;
	event.data.u32 = index_of(s, c);
	c->watched = epoll_ctl(s->epoll_fd, EPOLL_CTL_ADD, c->fd, &event) == 0;
	if (c->watched)
		return;
	client_refused(s, COUNT_refused_errors, &s->error_rate, strerror(errno));
	client_close(s, c);
}

/* Move the next request to the beginning of the area, and free the pages that it does not need. */
static void drop_past(struct client *c)
{
	bool large = c->have > AREA_ANSWER || c->out_len > 4096 - AREA_ANSWER;

	c->have -= c->past;
	if (c->have)
		memmove(c->area, c->area + c->past, c->have);
	if (large && c->have <= 4096)
		madvise(c->area + 4096, AREA_SIZE - 4096, MADV_DONTNEED);
	c->past = 0;
	c->out_len = 0;
}

void client_back(struct serve *s, struct client *c)
{
	c->lent = false;
	if (c->past)
		drop_past(c);
	if (c->state != CLIENT_WORKING)
		release_directory(c);
	if (c->state == CLIENT_LEFT)
		put_free(s, c);
	else
		client_ready(s, c);
}

bool client_evict(struct serve *s)
{
	struct client *oldest = NULL;

	for (unsigned i = 0; i < s->used; i++) {
		struct client *c = &s->clients[i];

		if (c->state == CLIENT_READING && !c->have && !c->lent && !c->queued &&
		    (!oldest || c->active_ns < oldest->active_ns))
			oldest = c;
	}
	if (!oldest)
		return false;
	if (s->now_ns - oldest->active_ns < EVICT_NS) {
		s->look_ns = earlier_ns(s->look_ns, oldest->active_ns + EVICT_NS);
		return false;
	}
	client_close(s, oldest);
	count(s, COUNT_evicted, 1);
	return true;
}

void client_event(struct serve *s, struct client *c, uint32_t events)
{
	if (c->fd < 0)
		return;
	if (events & (EPOLLERR | EPOLLHUP)) {
		client_close(s, c);
		return;
	}
	c->ended |= (events & EPOLLRDHUP) != 0;
	if (events & (EPOLLIN | EPOLLRDHUP)) {
		if (!c->readable)
			c->came_ns = s->came_ns;
		c->readable = true;
	}
	if (c->state == CLIENT_SENDING ? events & EPOLLOUT
	                               : c->state == CLIENT_READING && c->readable)
		client_ready(s, c);
}

/* --- Out -------------------------------------------------------------------------------------- */

uint8_t *client_room(struct client *c)
{
	size_t at = c->have > AREA_ANSWER ? (c->have + 63) & ~(size_t)63 : AREA_ANSWER;

	return c->area + at + FRAME_HEADER;
}

uint32_t client_room_size(struct client *c)
{
	return (uint32_t)(c->area + AREA_SIZE - client_room(c));
}

/* After a call that sends or receives: is the connection to be closed, since it costs too much? */
static bool over_budget(struct serve *s, struct client *c, const struct budget_call *call,
                        size_t bytes)
{
	int err = errno;
	bool over = !budget_end(&c->budget, call, bytes);

	if (over)
		client_refused(s, COUNT_costly, &s->costly_rate,
		               "its peer has its own end watched so often that each byte to it "
		               "takes long");
	errno = err;
	return over;
}

/* Returns how many bytes were sent, 0: none now, -1: the client has left. */
static ssize_t push(struct serve *s, struct client *c, const uint8_t *bytes, size_t len, int flags)
{
	struct budget_call call;
	ssize_t n;

	do {
		budget_begin(&c->budget, &call);
		n = send(c->fd, bytes, len, MSG_NOSIGNAL | MSG_DONTWAIT | flags);
	} while (n < 0 && errno == EINTR);
	if (over_budget(s, c, &call, len))
		return -1;
	if (n < 0)
		return errno == EAGAIN || errno == EWOULDBLOCK ? 0 : -1;
	count(s, COUNT_bytes_out, (uint64_t)n);
	return n;
}

/* Send the rest of a keep-alive. False: some bytes are left, or the client has left. */
static bool push_alive(struct serve *s, struct client *c)
{
	ssize_t n;

	if (!c->alive_left)
		return true;
	n = push(s, c, alive_frame + FRAME_HEADER - c->alive_left, c->alive_left, 0);
	if (n < 0)
		client_close(s, c);
	if (n <= 0)
		return false;
	c->alive_left = (uint8_t)(c->alive_left - n);
	return c->alive_left == 0;
}

static void send_alive(struct serve *s, struct client *c)
{
	c->tick_ns = s->now_ns;
	if (!c->alive_left) {
		c->alive_left = FRAME_HEADER;
		count(s, COUNT_keepalives, 1);
	}
	push_alive(s, c);
}

/* The answer is sent. The area keeps the request while a bus still uses its bytes. */
static void next_request(struct serve *s, struct client *c)
{
	if (!c->lent)
		release_directory(c);
	c->served++;
	c->past = c->length;
	if (c->request.type != FRAME_NOP)
		c->active_ns = s->now_ns;
	if (!c->lent)
		drop_past(c);
	if (!(c->request.flags & FRAME_PERSIST)) {
		client_close(s, c);
		return;
	}
	c->need = FRAME_HEADER;
	client_enter(s, c, CLIENT_READING);
	if (c->have || c->readable)
		client_ready(s, c);
}

/*
 * The connection ends with this answer: one packet carries the answer's end and that of the
 * connection. Where the client has sent more, the kernel would drop the answer then.
 */
static bool is_last(const struct client *c)
{
	return !(c->request.flags & FRAME_PERSIST) && !c->readable && c->have == c->length;
}

static void go_on_sending(struct serve *s, struct client *c)
{
	ssize_t n;

	if (!push_alive(s, c))
		return;
	n = push(s, c, c->out + c->out_at, c->out_len - c->out_at, is_last(c) ? MSG_MORE : 0);
	if (n < 0) {
		client_close(s, c);
		return;
	}
	c->out_at += (uint32_t)n;
	if (n)
		c->tick_ns = s->now_ns;
	if (c->out_at == c->out_len)
		next_request(s, c);
	/* epoll reports when the kernel takes the rest */
}

void client_send(struct serve *s, struct client *c, const uint8_t *bytes, uint32_t len)
{
	c->out = bytes;
	c->out_len = len;
	c->out_at = 0;
	client_enter(s, c, CLIENT_SENDING);
	go_on_sending(s, c);
}

/* --- In --------------------------------------------------------------------------------------- */

static ssize_t receive_bytes(struct serve *s, struct client *c, uint8_t *bytes, size_t room)
{
	struct budget_call call;
	ssize_t n;

	budget_begin(&c->budget, &call);
	if (c->network) {
		n = recv(c->fd, bytes, room, MSG_DONTWAIT);
		n = n < 0 ? -errno : n;
	} else {
		n = peer_receive(c->fd, bytes, room, true);
	}
	return over_budget(s, c, &call, room) ? -ECONNRESET : n;
}

/* Receive what is there, up to the end of the present request. False: the client has left. */
static bool client_receive(struct serve *s, struct client *c)
{
	size_t room = (c->need > FIRST_READ ? c->need : FIRST_READ) - c->have;
	ssize_t n;

	do
		n = receive_bytes(s, c, c->area + c->have, room);
	while (n == -EINTR);
	if (n == -EAGAIN) {
		c->readable = false;
		c->came_ns = s->now_ns;
		return true;
	}
	if (n <= 0)
		return false;
	c->given_ns = c->came_ns;
	/* the end of the stream, after these bytes, has no event of its own */
	if ((size_t)n < room && !c->ended) {
		c->readable = false;
		c->came_ns = s->now_ns;
	}
	if (!c->have)
		client_enter(s, c, CLIENT_READING);
	c->have += (size_t)n;
	count(s, COUNT_bytes_in, (uint64_t)n);
	return true;
}

/* True: the client has a request. */
static bool read_request(struct serve *s, struct client *c)
{
	int state;

	if (c->lent) /* a bus still uses the bytes in the area */
		return false;
	state = request_parse(c->area, c->have, &c->request, &c->length);
	if (state == 0 && c->readable) {
		c->need = c->length;
		if (!client_receive(s, c)) {
			client_close(s, c);
			return false;
		}
		state = request_parse(c->area, c->have, &c->request, &c->length);
	}
	if (state < 0) {
		count(s, COUNT_garbage, 1);
		client_close(s, c);
	} else if (state == 0) {
		c->need = c->length;
		if (c->readable)
			client_ready(s, c);
	} else {
		count(s, COUNT_requests, 1);
		/* the answer reports this: a client that wants more connects again */
		if (s->held.is && !s->free_count && c->request.flags & FRAME_PERSIST) {
			c->request.flags &= ~FRAME_PERSIST;
			count(s, COUNT_not_kept, 1);
		}
	}
	return state > 0;
}

bool client_again(struct serve *s, struct client *c)
{
	if (c->state != CLIENT_READING || c->fd < 0 || c->lent || c->have || c->queued)
		return false;
	/* what had come when epoll reported last is read */
	if (c->watched && !c->readable && c->came_ns < s->asked_ns)
		c->came_ns = s->asked_ns;
	c->readable = true;
	if (!client_receive(s, c))
		client_close(s, c);
	else if (c->have)
		client_ready(s, c);
	return c->queued;
}

bool client_turn(struct serve *s, struct client *c)
{
	switch ((enum client_state)c->state) {
	case CLIENT_FREE:
	case CLIENT_LEFT:
	case CLIENT_WORKING:
	case CLIENT_QUEUED:
	case CLIENT_APPLYING:
		return false;
	case CLIENT_READING:
		return read_request(s, c);
	case CLIENT_SENDING:
		go_on_sending(s, c);
		return false;
	}
	return false;
}

/* --- Time limits ------------------------------------------------------------------------------ */

static void client_look(struct serve *s, struct client *c)
{
	if (s->now_ns < limit_of(c))
		return;
	switch ((enum client_state)c->state) {
	case CLIENT_FREE:
	case CLIENT_LEFT:
		return;
	case CLIENT_WORKING:
	case CLIENT_QUEUED:
	case CLIENT_APPLYING:
		send_alive(s, c);
		return;
	case CLIENT_READING:
	case CLIENT_SENDING:
		count(s, COUNT_timeouts, 1);
		client_close(s, c);
		return;
	}
}

void clients_look(struct serve *s)
{
	int64_t next = INT64_MAX;

	for (unsigned i = 0; i < s->used; i++) {
		struct client *c = &s->clients[i];

		if (c->state == CLIENT_APPLYING && s->now_ns + APPLY_LOOK_NS < next)
			next = s->now_ns + APPLY_LOOK_NS;
		client_look(s, c);
		next = earlier_ns(next, limit_of(c));
	}
	s->look_ns = next;
	/* one of the clients may be idle for long enough by now, or a descriptor free */
	accept_again(s);
}
