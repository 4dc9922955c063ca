/* SPDX-License-Identifier: MIT */
/* recv(), send(), sendmsg() and sendfile() of libmicrohttpd, and what is given to the porter. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/web/crowd.h"
#include "src/faces/web/wire.h"
#include "src/ground/service/budget.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/peer.h"
#include "src/memory/shm/porter.h"

#define LATER_NS (10 * NS_PER_MS) /* until a porter that has too much to do is asked again */
#define TEND_NS NS_PER_S
#define DRAINS 4

struct wire {
	bool used, local;
	int place;
	struct budget budget;
};

static struct wire wires[WIRE_FDS];
static int away[WIRE_AWAY];
static unsigned away_count;
static struct porter *porter;
static int64_t tended_ns;
static struct log *reports;
/* Other threads call what is replaced here too, and have no connection of the page. */
static _Thread_local bool has_wires;

static struct wire *wire_of(int fd)
{
	return has_wires && fd >= 0 && fd < WIRE_FDS && wires[fd].used ? &wires[fd] : NULL;
}

/* --- In place of the C library's ------------------------------------------------------------- */

ssize_t wire_recv(int fd, void *to, size_t room, int flags) __asm__("recv");
ssize_t wire_send(int fd, const void *from, size_t len, int flags) __asm__("send");
ssize_t wire_sendmsg(int fd, const struct msghdr *message, int flags) __asm__("sendmsg");
#ifdef __GLIBC__
#define SENDFILE "sendfile64"
#else
#define SENDFILE "sendfile"
#endif
ssize_t wire_sendfile(int fd, int file, off_t *offset, size_t len) __asm__(SENDFILE);

/* The result of a call: an error that ends the connection when its peer has made it too slow. */
static ssize_t wire_result(struct wire *wire, const struct budget_call *call, ssize_t n)
{
	int err = errno;

	if (!budget_end(&wire->budget, call, n > 0 ? (size_t)n : 0)) {
		errno = ECONNRESET;
		return -1;
	}
	errno = err;
	return n;
}

/* libmicrohttpd alone receives without flags. */
ssize_t wire_recv(int fd, void *to, size_t room, int flags)
{
	struct wire *wire = flags ? NULL : wire_of(fd);
	struct budget_call call;
	ssize_t n;

	if (!wire)
		return recvfrom(fd, to, room, flags, NULL, NULL);
	budget_begin(&wire->budget, &call);
	n = wire->local ? peer_receive(fd, to, room, true)
	                : recvfrom(fd, to, room, flags, NULL, NULL);
	if (wire->local && n < 0) {
		errno = n == -EBADMSG ? ECONNRESET : (int)-n;
		n = -1;
	}
	return wire_result(wire, &call, n);
}

ssize_t wire_send(int fd, const void *from, size_t len, int flags)
{
	struct wire *wire = wire_of(fd);
	struct budget_call call;

	if (!wire)
		return sendto(fd, from, len, flags, NULL, 0);
	budget_begin(&wire->budget, &call);
	return wire_result(wire, &call, sendto(fd, from, len, flags, NULL, 0));
}

ssize_t wire_sendmsg(int fd, const struct msghdr *message, int flags)
{
	struct wire *wire = wire_of(fd);
	struct budget_call call;

	if (!wire)
		return syscall(SYS_sendmsg, fd, message, flags);
	budget_begin(&wire->budget, &call);
	return wire_result(wire, &call, syscall(SYS_sendmsg, fd, message, flags));
}

#ifndef SYS_sendfile64
#define SYS_sendfile64 SYS_sendfile /* where all offsets have 64 bits */
#endif

ssize_t wire_sendfile(int fd, int file, off_t *offset, size_t len)
{
	struct wire *wire = wire_of(fd);
	struct budget_call call;

	if (!wire)
		return syscall(SYS_sendfile64, fd, file, offset, len);
	budget_begin(&wire->budget, &call);
	return wire_result(wire, &call, syscall(SYS_sendfile64, fd, file, offset, len));
}

/* --- Connections ----------------------------------------------------------------------------- */

int wire_open(struct log *log)
{
	has_wires = true;
	reports = log;
	return porter_start(&porter);
}

bool wire_begin(int fd, bool local, int place)
{
	if (fd >= WIRE_FDS)
		return false;
	wires[fd] = (struct wire){.used = true, .local = local, .place = place};
	return true;
}

ptrdiff_t wire_look(int fd, void *bytes, size_t room)
{
	const struct wire *wire = wire_of(fd);
	ssize_t n;

	if (wire && wire->local)
		return peer_receive(fd, bytes, room, false);
	n = recvfrom(fd, bytes, room, MSG_PEEK | MSG_DONTWAIT, NULL, NULL);
	return n < 0 ? -errno : n;
}

void wire_drain(int fd, void *room, size_t size)
{
	const struct wire *wire = wire_of(fd);
	ptrdiff_t n = 1;

	for (int i = 0; i < DRAINS && n > 0; i++)
		n = wire && wire->local ? peer_receive(fd, room, size, true)
		                        : recvfrom(fd, room, size, MSG_DONTWAIT, NULL, NULL);
}

static void give_away(int fd)
{
	if (fd >= 0 && away_count < WIRE_AWAY)
		away[away_count++] = fd;
	else if (fd >= 0)
		close(fd);
}

int wire_leave(int fd)
{
	struct wire *wire = wire_of(fd);
	int place = wire ? wire->place : CROWD_NOBODY;

	if (!wire)
		return place;
	/* so that the last copy is the porter's */
	if (wire->local || wire->budget.over)
		give_away(fcntl(fd, F_DUPFD_CLOEXEC, 0));
	wire->used = false;
	return place;
}

int wire_close(int fd)
{
	struct wire *wire = wire_of(fd);
	int place = wire ? wire->place : CROWD_NOBODY;

	if (wire && !wire->local && !wire->budget.over)
		close(fd);
	else
		give_away(fd);
	if (wire)
		wire->used = false;
	return place;
}

void wire_close_listener(int fd)
{
	/* not hung up: that would end each copy of it */
	struct porter_order order = {.slot = PORTER_NO_SLOT, .fds = {fd}, .count = 1};

	if (porter_give(porter, PORTER_SERVED, &order))
		close(fd);
}

static void wire_flush(void)
{
	while (away_count) {
		struct porter_order order = {.what = PORTER_EACH | PORTER_HANG_UP,
		                             .slot = PORTER_NO_SLOT};

		order.count = away_count < PORTER_FDS ? away_count : PORTER_FDS;
		memcpy(order.fds, away + away_count - order.count,
		       order.count * sizeof(*order.fds));
		if (porter_give(porter, PORTER_SERVED, &order))
			return;
		away_count -= order.count;
	}
}

void wire_run(int64_t now_ns)
{
	wire_flush();
	if (now_ns - tended_ns < TEND_NS)
		return;
	tended_ns = now_ns;
	switch (porter_tend(porter, now_ns)) {
	case PORTER_ENDED:
		log_err(reports,
		        "the process for connections, owsd-porter, was killed: owsd-web "
		        "starts it again; until then users of the socket can delay the page");
		return;
	case PORTER_FAILED:
		log_err(reports, "the process for connections cannot be started: owsd-web tries "
		                 "again, each minute at last");
		return;
	case PORTER_IS_BACK:
		log_notice(reports, "the process for connections runs again (process %d)",
		           porter_process(porter));
		return;
	case PORTER_GOES_ON:
		return;
	}
}

int64_t wire_next(int64_t now_ns)
{
	return away_count ? now_ns + LATER_NS : INT64_MAX;
}

bool wire_is_full(void)
{
	return away_count >= WIRE_AWAY / 4;
}

void wire_end(void)
{
	wire_flush();
	porter_end(porter);
	porter = NULL;
}
