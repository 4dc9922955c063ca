/* SPDX-License-Identifier: MIT */
/* What owsd sends over the socket. */
#include <errno.h>
#include <linux/sockios.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>

#include "src/memory/control/welcome.h"

void welcome_refusal(enum welcome_deed deed, int err, const char *door, char *text, size_t size)
{
	static const char *const deeds[] = {[WELCOME_CONNECT] = "connect to",
	                                    [WELCOME_COMMAND] = "command by",
	                                    [WELCOME_RELOAD] = "reload by"};

	snprintf(
		text, size, "%s %s: %s", deeds[deed], door,
		err == -ENOSPC   ? "there are too many, of this user or all"
		: err != -EACCES ? strerror(-err)
		: deed == WELCOME_RELOAD
			? "that is for root, the user of owsd and, of the service, group owsd-config"
			: "it has no right to");
}

void welcome_report(struct control *c, const struct peer *peer, enum welcome_deed deed, int err)
{
	char others[LOG_OTHERS], text[200];
	uint64_t n = log_rate(&c->refused, c->now_ns);

	if (!n)
		return;
	welcome_refusal(deed, err, c->name, text, sizeof(text));
	log_warning(c->log, "process %d of user %u may not %s%s", (int)peer->pid,
	            (unsigned)peer->uid, text, log_others(n, others));
}

int welcome_end(struct control *c, const int *fds, unsigned count, int err, bool keep)
{
	struct ows_welcome no = {
		.magic = OWS_WELCOME_MAGIC,
		.major = OWS_LAYOUT_MAJOR,
		.minor = OWS_LAYOUT_MINOR,
		.err = err,
	};
	struct porter_order order = {
		.what = PORTER_EACH | PORTER_HANG_UP | (err ? PORTER_SEND : 0),
		.count = count,
		.keep = keep,
		.slot = PORTER_NO_SLOT,
		.bytes = {&no, err ? sizeof(no) : 0},
	};

	memcpy(order.fds, fds, count * sizeof(*fds));
	return porter_give(c->porter, PORTER_AWAY, &order);
}

static uint32_t porter_slot(const struct control *c, const struct control_seat *p)
{
	return (uint32_t)(p - c->seats);
}

bool welcome_unread(struct control *c, const struct control_seat *p)
{
	int bytes = 0;

	if (p->fd < 0)
		return false;
	if (!porter_carried(c->porter, porter_slot(c, p))) {
		c->later = true;
		return true;
	}
	return ioctl(p->fd, SIOCOUTQ, &bytes) == 0 && bytes > 0;
}

void welcome_send(struct control *c, struct control_seat *p)
{
	const struct controller_layout *layout = p->now.memory.layout;
	struct ows_welcome welcome = {
		.magic = OWS_WELCOME_MAGIC,
		.major = OWS_LAYOUT_MAJOR,
		.minor = OWS_LAYOUT_MINOR,
		.generation = layout->header.generation,
		.start_id = layout->header.start_id,
		.serial = p->who.serial,
		.size = layout->header.size,
	};
	struct porter_order order = {
		.what = PORTER_SEND,
		.count = p->news_end >= 0 ? 4 : 2,
		.keep = 1 | 4, /* the connection and the bell */
		.slot = porter_slot(c, p),
		.fds = {p->fd, p->now.memfd, p->bell, p->news_end},
		.bytes = {&welcome, sizeof(welcome)},
	};

	/* memories would pile up in the socket of a program that is stopped while owsd reloads */
	if (welcome_unread(c, p))
		return;
	memcpy(welcome.token, p->token, sizeof(welcome.token));
	if (porter_give(c->porter, PORTER_IN, &order)) {
		c->later = true;
		return;
	}
	p->now.memfd = p->news_end = -1;
	p->sent = p->welcomed = true;
}
