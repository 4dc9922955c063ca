/* SPDX-License-Identifier: MIT */
/* What owsd sends over the socket. */
#include <errno.h>
#include <linux/sockios.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "src/control/welcome.h"

void welcome_refuse(struct control *c, int fd, const struct peer *peer, int err)
{
	const struct ows_welcome no = {
		.magic = OWS_WELCOME_MAGIC,
		.major = OWS_LAYOUT_MAJOR,
		.minor = OWS_LAYOUT_MINOR,
		.err = err,
	};
	char others[LOG_OTHERS];
	uint64_t n = log_rate(&c->refused, c->now_ns);

	send(fd, &no, sizeof(no), MSG_DONTWAIT | MSG_NOSIGNAL);
	if (n)
		log_warning(c->log, "process %d of user %u may not connect to %s: %s%s",
		            (int)peer->pid, (unsigned)peer->uid, c->name,
		            err == -EACCES   ? "it has no right to"
		            : err == -ENOSPC ? "there are too many, of this user or all"
		                             : strerror(-err),
		            log_others(n, others));
}

bool welcome_unread(const struct control_place *p)
{
	int bytes = 0;

	return p->fd >= 0 && ioctl(p->fd, SIOCOUTQ, &bytes) == 0 && bytes > 0;
}

static void attach(struct msghdr *message, const int *fds, size_t n)
{
	struct cmsghdr *c = message->msg_control; /* CMSG_FIRSTHDR(): there is room for one */

	c->cmsg_level = SOL_SOCKET;
	c->cmsg_type = SCM_RIGHTS;
	c->cmsg_len = CMSG_LEN(n * sizeof(int));
	memcpy(CMSG_DATA(c), fds, n * sizeof(int));
}

static int send_all(const struct control_place *p, struct ows_welcome *welcome)
{
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(3 * sizeof(int))];
	} room = {{0}};
	const int fds[] = {p->now.memfd, p->bell, p->news_end};
	size_t n = p->news_end >= 0 ? 3 : 1;
	struct iovec part = {.iov_base = welcome, .iov_len = sizeof(*welcome)};
	struct msghdr message = {
		.msg_iov = &part,
		.msg_iovlen = 1,
		.msg_control = &room,
		.msg_controllen = CMSG_SPACE(n * sizeof(int)),
	};

	attach(&message, fds, n);
	return sendmsg(p->fd, &message, MSG_DONTWAIT | MSG_NOSIGNAL) < 0 ? -errno : 0;
}

int welcome_send(struct control_place *p)
{
	const struct giver_layout *layout = p->now.memory.layout;
	struct ows_welcome welcome = {
		.magic = OWS_WELCOME_MAGIC,
		.major = OWS_LAYOUT_MAJOR,
		.minor = OWS_LAYOUT_MINOR,
		.generation = layout->generation,
		.start_id = layout->start_id,
		.serial = p->who.serial,
		.size = layout->size,
	};
	int err;

	/* memories would pile up in the socket of a program that is stopped while owsd reloads */
	if (welcome_unread(p))
		return 0;
	memcpy(welcome.token, p->token, sizeof(welcome.token));
	err = send_all(p, &welcome);
	if (err == -EAGAIN || err == -EINTR)
		return 0;
	if (err)
		return err;
	close(p->now.memfd);
	p->now.memfd = -1;
	if (p->news_end >= 0)
		close(p->news_end);
	p->news_end = -1;
	p->sent = p->welcomed = true;
	return 0;
}
