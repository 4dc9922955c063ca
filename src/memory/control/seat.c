/* SPDX-License-Identifier: MIT */
/* How a seat ends: the refusal, the end of the connection, what the seat had goes to the porter. */
#include <errno.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "src/memory/control/ask.h"
#include "src/memory/control/held.h"
#include "src/memory/control/news.h"
#include "src/memory/control/seat.h"
#include "src/memory/control/welcome.h"

int seat_watch(struct control *c, const struct control_seat *p, int fd, uint32_t what)
{
	struct epoll_event event = {.events = EPOLLIN | EPOLLOUT | EPOLLRDHUP | EPOLLET};

	event.data.u32 = (uint32_t)(p - c->seats) * 2 + what;
	return epoll_ctl(c->epoll, EPOLL_CTL_ADD, fd, &event) < 0 ? -errno : 0;
}

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

/* Once. */
static void hang_up_on(struct control *c, struct control_seat *p)
{
	if (!p->connected || p->fd < 0)
		return;
	p->connected = welcome_end(c, &p->fd, 1, p->refused, true) != 0;
	c->later |= p->connected;
}

void seat_release(struct control *c, struct control_seat *p)
{
	bool unread;

	held_free(c, p->peer.uid, &p->now, false);
	held_free(c, p->peer.uid, &p->next, false);
	peer_forget(&p->peer);
	if (p->death >= 0) {
		/* while a porter that begins has it too, closing it does not take it out */
		epoll_ctl(c->epoll, EPOLL_CTL_DEL, p->death, NULL);
		close(p->death);
	}
	p->death = -1;
	hang_up_on(c, p);
	/*
	 * what lies unread in the socket of a living process counts among owsd's descriptors: its
	 * user has one seat less until then
	 */
	unread = p->sent && welcome_unread(c, p);
	if ((p->connected && p->fd >= 0) || !give_away(c, p, !unread)) {
		control_enter(p, CONTROL_LEFT);
	} else if (unread) {
		control_enter(p, CONTROL_UNREAD);
	} else {
		bus_count(&c->counters[CONTROL_connections], (uint64_t)-1);
		control_enter(p, CONTROL_FREE);
	}
}

void seat_changed(struct control *c)
{
	__atomic_fetch_add(&c->changes, 1, __ATOMIC_RELEASE);
	c->ring(c->ring_ctx);
}

void seat_leave(struct control *c, struct control_seat *p)
{
	control_enter(p, CONTROL_LEAVING);
	seat_changed(c);
}

void seat_drop(struct control *c, struct control_seat *p, enum control_counter why)
{
	uint32_t joining = CONTROL_JOINING;

	if (p->leaves)
		return;
	control_tally(c, why);
	p->leaves = true;
	if (p->now.memory.base)
		controller_state(&p->now.memory, OWS_STATE_STOPPED);
	hang_up_on(c, p);
	if (control_state_of(p) == CONTROL_HALF || ask_waits(p) ||
	    __atomic_compare_exchange_n(&p->state, &joining, CONTROL_LEFT, false, __ATOMIC_ACQ_REL,
	                                __ATOMIC_ACQUIRE))
		seat_release(c, p);
	else if (control_state_of(p) == CONTROL_IN)
		seat_leave(c, p);
	/* else the engine's thread takes it this moment: door_look() goes on */
}

void seat_died(struct control *c, struct control_seat *p)
{
	if (control_belongs(p))
		seat_drop(c, p, CONTROL_died);
}

void seat_refuse(struct control *c, struct control_seat *p, int err, enum control_counter why)
{
	welcome_report(c, &p->peer, p->deed, err);
	p->refused = err;
	seat_drop(c, p, why);
}
