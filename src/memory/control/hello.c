/* SPDX-License-Identifier: MIT */
/* The first words of a program: who it is, what it may do, and what it gets. */
#include <errno.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/random.h>
#include <sys/socket.h>

#include "src/memory/control/ask.h"
#include "src/memory/control/grant.h"
#include "src/memory/control/held.h"
#include "src/memory/control/hello.h"
#include "src/memory/control/news.h"
#include "src/memory/control/seat.h"

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

/* 0, -ESRCH: the process has ended, or another negative errno. */
static int open_descriptors(struct control *c, struct control_seat *p)
{
	const int least = 0;
	int ends[2];

	p->death = peer_death(p->fd, &p->peer);
	if (p->death == -ESRCH)
		return -ESRCH;
	if (p->death >= 0 && seat_watch(c, p, p->death, 1))
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
		seat_drop(c, p, CONTROL_died);
		return;
	}
	if (!err)
		err = grant_make(&p->now, c->layout, &c->rights, p);
	if (err) {
		seat_refuse(c, p, err, CONTROL_refused_errors);
		return;
	}
	control_tally(c, CONTROL_joined);
	log_info(c->log, "controller " LOG_PROGRAM " may command %u signals", p->who.name,
	         (int)p->who.pid, (unsigned)p->who.uid, p->now.allowed);
	control_enter(p, CONTROL_JOINING);
	seat_changed(c);
}

static void ask_for_reload(struct control *c, struct control_seat *p, const struct ows_hello *hello)
{
	if (!rights_reload(&c->rights, &p->peer))
		seat_refuse(c, p, -EACCES, CONTROL_refused_rights);
	else if (ask_begin(c, p, hello))
		seat_refuse(c, p, -ENOSPC, CONTROL_refused_limits);
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
		ask_for_reload(c, p, hello);
	else if (!may_join(c, p, hello))
		seat_refuse(c, p, -EACCES, CONTROL_refused_rights);
	else if (!has_room(c, p))
		seat_refuse(c, p, -ENOSPC, CONTROL_refused_limits);
	else
		join_controller(c, p, hello);
}

void hello_take(struct control *c, struct control_seat *p)
{
	struct ows_hello hello;
	ptrdiff_t n = peer_receive(p->fd, &hello, sizeof(hello), false);

	if (n == -EAGAIN || n == -EINTR)
		return;
	if (n <= 0 && n != -EBADMSG)
		seat_drop(c, p, CONTROL_hung_up);
	else if (n != (ssize_t)sizeof(hello) || hello.magic != OWS_HELLO_MAGIC ||
	         hello.major != OWS_LAYOUT_MAJOR)
		seat_refuse(c, p, -EPROTO, CONTROL_refused_protocol);
	else
		admit(c, p, &hello);
}
