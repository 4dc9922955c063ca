/* SPDX-License-Identifier: MIT */
/* Connections: which get a seat, and how they go on. */
#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/ioctl.h>

#include "hal/base/time.h"
#include "src/ground/service/listen.h"
#include "src/memory/control/ask.h"
#include "src/memory/control/door.h"
#include "src/memory/control/held.h"
#include "src/memory/control/hello.h"
#include "src/memory/control/often.h"
#include "src/memory/control/seat.h"
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
/* How often owsd looks whether what it gave away is empty. */
#define HELD_NS (100 * NS_PER_MS)
/* How long owsd waits for a porter that has too much to do. */
#define PORTER_NS (10 * NS_PER_MS)

/* A program sends nothing after its hello, which lies unread where it came. */
static void look_for_end(struct control *c, struct control_seat *p)
{
	struct pollfd end = {.fd = p->fd, .events = POLLRDHUP};
	int bytes = 0;

	if (ioctl(p->fd, FIONREAD, &bytes) == 0 && bytes > (int)sizeof(struct ows_hello))
		seat_drop(c, p, CONTROL_refused_protocol);
	else if (poll(&end, 1, 0) == 1)
		seat_drop(c, p, CONTROL_hung_up);
}

void door_event(struct control *c, struct control_seat *p)
{
	if (control_state_of(p) == CONTROL_HALF)
		hello_take(c, p);
	switch (control_state_of(p)) {
	case CONTROL_ASKING:
	case CONTROL_ASKED:
	case CONTROL_JOINING: /* what came along with the hello brings no other event */
	case CONTROL_TAKEN:
	case CONTROL_IN:
		look_for_end(c, p);
		break;
	case CONTROL_FREE:
	case CONTROL_HALF:
	case CONTROL_LEAVING:
	case CONTROL_LEFT:
	case CONTROL_UNREAD: /* door_look() sees what lies unread */
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
		err = seat_watch(c, p, fd, 0);
	}
	if (!err) {
		control_enter(p, CONTROL_HALF);
		control_tally(c, CONTROL_connections);
		return;
	}
	control_tally(c, err == -EACCES   ? CONTROL_refused_rights
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

	control_tally(c, CONTROL_refused_errors);
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
			seat_refuse(c, p, -ETIMEDOUT, CONTROL_refused_protocol);
		break;
	case CONTROL_ASKING:
	case CONTROL_ASKED:
		if (c->now_ns < p->until_ns)
			break;
		ask_answer(c, p, -ETIMEDOUT, "");
		seat_drop(c, p, CONTROL_asked);
		break;
	case CONTROL_IN:
		if (p->leaves)
			seat_leave(c, p);
		else if (!p->welcomed)
			welcome_send(c, p);
		break;
	case CONTROL_LEFT:
	case CONTROL_UNREAD:
		seat_release(c, p);
		break;
	case CONTROL_FREE:
	case CONTROL_JOINING:
	case CONTROL_TAKEN:
	case CONTROL_LEAVING:
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
