/* SPDX-License-Identifier: MIT */
/* Connections: which get a seat, what was sent over them, and how they end. */
#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/ground/service/listen.h"
#include "src/memory/control/ask.h"
#include "src/memory/control/door.h"
#include "src/memory/control/grant.h"
#include "src/memory/control/held.h"
#include "src/memory/control/news.h"
#include "src/memory/control/often.h"
#include "src/memory/control/welcome.h"
#include "src/public/ows.h"

/*
 * owsd accepts for so long, then it rests for so many times as long as it took: connections without
 * end cost the tenth of a core, porter included. They are taken in bursts, since where the queue of
 * the socket is full a program that waits for room in it has to find some before those that
 * hammer.
 */
#define BURST_NS (6 * NS_PER_MS)
#define REST 15
#define REST_MOST_NS (90 * NS_PER_MS)
/* A socket holds fewer messages. */
#define DRAINS 512

static void count(struct control *c, enum control_counter what)
{
	bus_count(&c->counters[what], 1);
}

/* How often owsd looks whether what it gave away is empty. */
#define HELD_NS (100 * NS_PER_MS)
/* How long owsd waits for a porter that has too much to do. */
#define PORTER_NS (10 * NS_PER_MS)

/* Give away what the seat has of the peer's. False: later. */
static bool give_away(struct control *c, struct control_seat *p, bool with_connection)
{
	int *fds[] = {&p->bell, &p->news, &p->news_end, with_connection ? &p->fd : NULL};
	struct porter_order order = {.slot = PORTER_NO_SLOT};

	if (!news_end(p)) {
		c->later = true;
		return false;
	}
	if (with_connection && p->fd >= 0)
		epoll_ctl(c->epoll, EPOLL_CTL_DEL, p->fd, NULL);
	for (unsigned i = 0; i < 4; i++)
		if (fds[i] && *fds[i] >= 0)
			order.fds[order.count++] = *fds[i];
	if (order.count && porter_give(c->porter, PORTER_AWAY, &order)) {
		c->later = true;
		return false;
	}
	for (unsigned i = 0; i < 4; i++)
		if (fds[i])
			*fds[i] = -1;
	return true;
}

static void door_enter(struct control_seat *p, enum control_state state)
{
	__atomic_store_n(&p->state, state, __ATOMIC_RELEASE);
}

/* Once. */
static void hang_up_on(struct control *c, struct control_seat *p)
{
	if (!p->connected || p->fd < 0)
		return;
	p->connected = welcome_end(c, &p->fd, 1, p->refused, true) != 0;
	c->later |= p->connected;
}

void door_release(struct control *c, struct control_seat *p)
{
	bool unread;

	held_free(c, p->peer.uid, &p->now, false);
	held_free(c, p->peer.uid, &p->next, false);
	peer_forget(&p->peer);
	if (p->death >= 0)
		close(p->death);
	p->death = -1;
	hang_up_on(c, p);
	/*
	 * what lies unread in the socket of a living process counts among owsd's descriptors: its
	 * user has one seat less until then
	 */
	unread = p->sent && welcome_unread(c, p);
	if ((p->connected && p->fd >= 0) || !give_away(c, p, !unread)) {
		door_enter(p, CONTROL_LEFT);
	} else if (unread) {
		door_enter(p, CONTROL_UNREAD);
	} else {
		bus_count(&c->counters[CONTROL_connections], (uint64_t)-1);
		door_enter(p, CONTROL_FREE);
	}
}

/* --- The end ---------------------------------------------------------------------------------- */

static void let_engine_look(struct control *c)
{
	__atomic_fetch_add(&c->changes, 1, __ATOMIC_RELEASE);
	c->ring(c->ring_ctx);
}

static void begin_leaving(struct control *c, struct control_seat *p)
{
	door_enter(p, CONTROL_LEAVING);
	let_engine_look(c);
}

void door_drop(struct control *c, struct control_seat *p, enum control_counter why)
{
	uint32_t joining = CONTROL_JOINING;

	if (p->leaves)
		return;
	count(c, why);
	p->leaves = true;
	if (p->now.memory.base)
		controller_state(&p->now.memory, OWS_STATE_STOPPED);
	hang_up_on(c, p);
	if (control_state_of(p) == CONTROL_HALF || ask_waits(p) ||
	    __atomic_compare_exchange_n(&p->state, &joining, CONTROL_LEFT, false, __ATOMIC_ACQ_REL,
	                                __ATOMIC_ACQUIRE))
		door_release(c, p);
	else if (control_state_of(p) == CONTROL_IN)
		begin_leaving(c, p);
	/* else the engine's thread takes it this moment: door_look() goes on */
}

void door_died(struct control *c, struct control_seat *p)
{
	if (control_belongs(p))
		door_drop(c, p, CONTROL_died);
}

static void door_refuse(struct control *c, struct control_seat *p, int err,
                        enum control_counter why)
{
	welcome_report(c, &p->peer, p->deed, err);
	p->refused = err;
	door_drop(c, p, why);
}

/* --- The hello -------------------------------------------------------------------------------- */

/* The first controller of a user has a memory of any size; the others of this generation count. */
static bool has_room(struct control *c, const struct control_seat *p)
{
	size_t has;

	held_of(c, p->peer.uid, &has);
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		if (c->seats[i].peer.uid == p->peer.uid)
			has += c->seats[i].now.size;
	return !p->peer.uid || !has || has + c->layout->header.size <= CONTROL_MEMORY;
}

static int door_watch(struct control *c, const struct control_seat *p, int fd, uint32_t what)
{
	struct epoll_event event = {.events = EPOLLIN | EPOLLOUT | EPOLLRDHUP | EPOLLET};

	event.data.u32 = (uint32_t)(p - c->seats) * 2 + what;
	return epoll_ctl(c->epoll, EPOLL_CTL_ADD, fd, &event) < 0 ? -errno : 0;
}

/* 0, -ESRCH: the process has ended, or another negative errno. */
static int open_descriptors(struct control *c, struct control_seat *p)
{
	const int least = 0;
	int ends[2];

	p->death = peer_death(p->fd, &p->peer);
	if (p->death == -ESRCH)
		return -ESRCH;
	if (p->death >= 0 && door_watch(c, p, p->death, 1))
		return -errno;
	p->bell = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	/*
	 * No pipe: its lock is held while a reader copies, for as long as the memory that it reads
	 * into may not come. A socket has none for the sender. Its reader sends nothing.
	 */
	if (p->bell < 0 ||
	    socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) < 0)
		return -errno;
	p->news_end = ends[0];
	p->news = ends[1];
	shutdown(p->news, SHUT_RD);
	setsockopt(p->news, SOL_SOCKET, SO_SNDBUF, &least, sizeof(least));
	news_begin(p);
	return 0;
}

static int identify_controller(struct control *c, struct control_seat *p,
                               const struct ows_hello *hello)
{
	static const uint8_t none[sizeof(hello->token)];

	p->commands = hello->flags & OWS_HELLO_COMMAND;
	p->who = (struct ows_who){.uid = p->peer.uid, .pid = p->peer.pid};
	controller_clean_name(p->who.name, hello->name);
	memcpy(p->token, hello->token, sizeof(p->token));
	if (memcmp(p->token, none, sizeof(none)) == 0 &&
	    getrandom(p->token, sizeof(p->token), 0) != (ssize_t)sizeof(p->token))
		return -EIO;
	p->who.serial = ++c->serial ? c->serial : ++c->serial;
	return 0;
}

static void join_controller(struct control *c, struct control_seat *p,
                            const struct ows_hello *hello)
{
	int err = identify_controller(c, p, hello);

	if (!err)
		err = open_descriptors(c, p);
	if (err == -ESRCH) {
		door_drop(c, p, CONTROL_died);
		return;
	}
	if (!err)
		err = grant_make(&p->now, c->layout, &c->rights, p);
	if (err) {
		door_refuse(c, p, err, CONTROL_refused_errors);
		return;
	}
	count(c, CONTROL_joined);
	log_info(c->log, "controller %s (process %d, user %u) may command %u signals", p->who.name,
	         (int)p->who.pid, (unsigned)p->who.uid, p->now.allowed);
	door_enter(p, CONTROL_JOINING);
	let_engine_look(c);
}

static void door_ask(struct control *c, struct control_seat *p, const struct ows_hello *hello)
{
	if (!rights_reload(&c->rights, &p->peer))
		door_refuse(c, p, -EACCES, CONTROL_refused_rights);
	else if (ask_begin(c, p, hello))
		door_refuse(c, p, -ENOSPC, CONTROL_refused_limits);
}

static bool may_join(const struct control *c, const struct control_seat *p,
                     const struct ows_hello *hello)
{
	return rights_set_any(&c->rights, &p->peer) ||
	       (!(hello->flags & OWS_HELLO_COMMAND) && rights_read(&c->rights, &p->peer));
}

static void admit(struct control *c, struct control_seat *p, const struct ows_hello *hello)
{
	p->deed = hello->flags & OWS_HELLO_RELOAD    ? WELCOME_RELOAD
	          : hello->flags & OWS_HELLO_COMMAND ? WELCOME_COMMAND
	                                             : WELCOME_CONNECT;
	if (p->deed == WELCOME_RELOAD)
		door_ask(c, p, hello);
	else if (!may_join(c, p, hello))
		door_refuse(c, p, -EACCES, CONTROL_refused_rights);
	else if (!has_room(c, p))
		door_refuse(c, p, -ENOSPC, CONTROL_refused_limits);
	else
		join_controller(c, p, hello);
}

static void take_hello(struct control *c, struct control_seat *p)
{
	struct ows_hello hello;
	ptrdiff_t n = peer_receive(p->fd, &hello, sizeof(hello), false);

	if (n == -EAGAIN || n == -EINTR)
		return;
	if (n <= 0 && n != -EBADMSG)
		door_drop(c, p, CONTROL_hung_up);
	else if (n != (ssize_t)sizeof(hello) || hello.magic != OWS_HELLO_MAGIC ||
	         hello.major != OWS_LAYOUT_MAJOR)
		door_refuse(c, p, -EPROTO, CONTROL_refused_protocol);
	else
		admit(c, p, &hello);
}

/* --- Connections ------------------------------------------------------------------------------ */

/* A program sends nothing after its hello, which lies unread where it came. */
static void look_for_end(struct control *c, struct control_seat *p)
{
	struct pollfd end = {.fd = p->fd, .events = POLLRDHUP};
	int bytes = 0;

	if (ioctl(p->fd, FIONREAD, &bytes) == 0 && bytes > (int)sizeof(struct ows_hello))
		door_drop(c, p, CONTROL_refused_protocol);
	else if (poll(&end, 1, 0) == 1)
		door_drop(c, p, CONTROL_hung_up);
}

void door_event(struct control *c, struct control_seat *p)
{
	if (control_state_of(p) == CONTROL_HALF)
		take_hello(c, p);
	switch (control_state_of(p)) {
	case CONTROL_ASKING:
	case CONTROL_ASKED:
	case CONTROL_JOINING: /* what came along with the hello brings no other event */
	case CONTROL_TAKEN:
	case CONTROL_IN:
		look_for_end(c, p);
		break;
	default: /* door_look() sees what lies unread */
		break;
	}
}

/* Programs of many users, and such as only want to hear of news, lock no other program out. */
static unsigned most_seats(const struct control *c, const struct peer *peer)
{
	if (!peer->uid || peer->uid == c->rights.own)
		return OWS_CONTROLLERS;
	return OWS_CONTROLLERS -
	       (rights_set_any(&c->rights, peer) ? CONTROL_KEPT : CONTROL_KEPT_FROM_READERS);
}

/* A free seat for that user; NULL: all are taken, or as many as a user may have. */
static struct control_seat *find_seat(struct control *c, const struct peer *peer)
{
	struct control_seat *found = NULL;
	size_t bytes;
	unsigned of_user = 0, taken = 0, held = held_of(c, peer->uid, &bytes);

	for (unsigned i = 0; i < OWS_CONTROLLERS; i++) {
		struct control_seat *p = &c->seats[i];

		if (control_state_of(p) == CONTROL_FREE) {
			found = found ? found : p;
			continue;
		}
		taken++;
		of_user += p->who.uid == peer->uid;
	}
	if (taken >= most_seats(c, peer) || (peer->uid && held_full(c)))
		return NULL;
	return peer->uid && (of_user >= CONTROL_OF_USER || held >= CONTROL_HELD) ? NULL : found;
}

/* All of the seat is new but its state, at which the engine's thread may look meanwhile. */
static void begin_seat(struct control_seat *p, const struct control_seat *fresh)
{
	size_t from = offsetof(struct control_seat, fd);

	memcpy((char *)p + from, (const char *)fresh + from, sizeof(*p) - from);
}

/* Hang up on those that have no seat. False: the porter has no time. */
static bool send_away(struct control *c)
{
	if (c->away_count && welcome_end(c, c->away, c->away_count, c->away_err, false))
		return false;
	c->away_count = 0;
	return true;
}

static bool comes_too_often(struct control *c, uid_t uid)
{
	return uid && uid != c->rights.own && often_is_too(&c->often, uid, c->now_ns);
}

static void meet(struct control *c, int fd)
{
	struct control_seat *p;
	struct peer peer;
	int err = peer_look(fd, &peer);

	p = err ? NULL : find_seat(c, &peer);
	if (!err && !rights_set_any(&c->rights, &peer) && !rights_read(&c->rights, &peer) &&
	    !rights_reload(&c->rights, &peer))
		err = -EACCES;
	else if (!err && (!p || comes_too_often(c, peer.uid)))
		err = -ENOSPC;
	if (!err) {
		begin_seat(p, &(struct control_seat){.fd = fd,
		                                     .death = -1,
		                                     .bell = -1,
		                                     .news = -1,
		                                     .news_end = -1,
		                                     .peer = peer,
		                                     .connected = true,
		                                     .who.uid = peer.uid,
		                                     .until_ns = c->now_ns + CONTROL_HELLO_NS});
		err = door_watch(c, p, fd, 0);
	}
	if (!err) {
		door_enter(p, CONTROL_HALF);
		count(c, CONTROL_connections);
		return;
	}
	count(c, err == -EACCES   ? CONTROL_refused_rights
	         : err == -ENOSPC ? CONTROL_refused_limits
	                          : CONTROL_refused_errors);
	welcome_report(c, &peer, WELCOME_CONNECT, err);
	peer_forget(&peer);
	/* door_accept() has seen to it that there is room for one at least */
	if (c->away_count && c->away_err != err && !send_away(c))
		err = c->away_err;
	c->away[c->away_count++] = fd;
	c->away_err = err;
}

/* The connection waits in the socket until there is room. */
static void report_full(struct control *c, int why)
{
	char others[LOG_OTHERS];
	uint64_t n = log_rate(&c->full, c->now_ns);

	count(c, CONTROL_refused_errors);
	if (n)
		log_warning(c->log, "no program can connect to %s: %s%s", c->name, strerror(why),
		            log_others(n, others));
}

static bool has_time(const struct control *c)
{
	return ows_now() - c->now_ns < BURST_NS;
}

/* True: there are more. full: owsd has no room for them. */
static bool accept_some(struct control *c, bool *full)
{
	while (has_time(c)) {
		int fd;

		if (c->away_count == PORTER_FDS && !send_away(c))
			break;
		fd = listen_accept(c->listener, NULL, NULL);
		if (fd >= 0) {
			meet(c, fd);
		} else if (fd == -EAGAIN) {
			return false;
		} else if (listen_is_full(fd)) {
			report_full(c, -fd);
			*full = true;
			break;
		}
	}
	return true;
}

void door_accept(struct control *c)
{
	int64_t rest_ns;
	bool full = false;

	c->accepts = accept_some(c, &full);
	c->accepts |= !send_away(c);
	rest_ns = (ows_now() - c->now_ns) * REST;
	c->accept_ns = c->now_ns + (full || rest_ns > REST_MOST_NS ? REST_MOST_NS : rest_ns);
}

static void look_at_seat(struct control *c, struct control_seat *p)
{
	switch (control_state_of(p)) {
	case CONTROL_HALF:
		if (c->now_ns >= p->until_ns)
			door_refuse(c, p, -ETIMEDOUT, CONTROL_refused_protocol);
		break;
	case CONTROL_ASKING:
	case CONTROL_ASKED:
		if (c->now_ns < p->until_ns)
			break;
		ask_answer(c, p, -ETIMEDOUT, "");
		door_drop(c, p, CONTROL_asked);
		break;
	case CONTROL_IN:
		if (p->leaves)
			begin_leaving(c, p);
		else if (!p->welcomed)
			welcome_send(c, p);
		break;
	case CONTROL_LEFT:
	case CONTROL_UNREAD:
		door_release(c, p);
		break;
	default:
		break;
	}
}

int64_t door_look(struct control *c)
{
	int64_t next_ns = c->accepts ? c->accept_ns : INT64_MAX;

	c->later = false;
	held_look(c);
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++) {
		struct control_seat *p = &c->seats[i];

		look_at_seat(c, p);
		if ((control_state_of(p) == CONTROL_HALF || ask_waits(p)) && p->until_ns < next_ns)
			next_ns = p->until_ns;
	}
	if (c->later && c->now_ns + PORTER_NS < next_ns)
		next_ns = c->now_ns + PORTER_NS;
	if (c->held_count && c->now_ns + HELD_NS < next_ns)
		next_ns = c->now_ns + HELD_NS;
	return next_ns;
}
