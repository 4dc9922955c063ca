/* SPDX-License-Identifier: MIT */
/*
 * The porter: a process of its own for what a peer can make slow. A descriptor that a peer has sent
 * may sleep for hours in close(); whoever wakes a socket walks all watches that its peer has put
 * there; a memory that a peer has may be locked by it. So no thread of owsd receives what may have
 * descriptors with it, sends over a connection, or closes what a peer had or has: it gives that to
 * the porter. The porter forks a child for it, and the child does it and ends: a process that ends
 * waits for no connection. A child that hangs holds nobody up; the porter goes on with the next.
 */
#ifndef SHM_PORTER_H
#define SHM_PORTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/uio.h>

/* Each has children of its own, and is used by one thread at a time. */
enum porter_lane {
	PORTER_AWAY,   /* connections that end */
	PORTER_IN,     /* welcomes */
	PORTER_SERVED, /* clients of the served protocol that end */
	PORTER_MEMORY, /* what givers had */
	PORTER_NEWS,   /* sleepers of an image, pipes of givers */
	PORTER_LANES,
};

#define PORTER_FDS 64
#define PORTER_BYTES 320
#define PORTER_SLOTS 128
#define PORTER_NO_SLOT UINT32_MAX

enum porter_what {
	PORTER_SEND = 1, /* the bytes over fds[0], with copies of the other descriptors */
	/* shut fds[0] down, and receive what lies there unless it hurts */
	PORTER_HANG_UP = 2,
	/* wake all that sleep on the news of the image fds[0] */
	PORTER_WAKE = 8,
	/* free the pages of the file fds[0] */
	PORTER_EMPTY = 16,
	PORTER_EACH = 4 /* that with each descriptor, as all are connections */
};

struct porter_order {
	unsigned what;  /* bits of enum porter_what; in any case the child lets all go */
	unsigned count; /* of descriptors, from 1 */
	uint64_t keep;  /* bits of the descriptors that stay open here too */
	uint32_t slot;  /* for porter_carried(); PORTER_NO_SLOT: none */
	int fds[PORTER_FDS];
	struct iovec bytes; /* at most PORTER_BYTES */
};

struct porter;

/* Fork the porter, before there is a thread. 0 or a negative errno. */
int porter_start(struct porter **porter);
/* End the porter after what it has; waits a second at most. NULL: does nothing. */
void porter_end(struct porter *porter);
/*
 * Give an order away: 0, and its descriptors are closed here, but those to keep. -EAGAIN:
 * the porter has too much to do, and nothing has happened. Never blocks. Without a porter (NULL,
 * or it was killed and no other is ready yet) the caller's thread does it.
 */
int porter_give(struct porter *porter, enum porter_lane lane, const struct porter_order *order);
/* Was the last order of that slot carried out, up to letting go? */
bool porter_carried(const struct porter *porter, uint32_t slot);

enum porter_event {
	PORTER_GOES_ON,
	PORTER_ENDED, /* somebody killed it: the caller's threads do it all until PORTER_IS_BACK */
	PORTER_IS_BACK, /* another is ready */
	PORTER_FAILED,  /* another could not be started, or ended before it was ready */
};
/*
 * Start a porter that was killed again: after a second, later after twice as long each time, up to
 * a minute. For one thread, at least each second. The new porter begins with copies of all that
 * owsd has open, some of which may be slow to close: so it gets the lanes only when it is done with
 * that, and is killed if it takes two seconds. Never blocks.
 */
enum porter_event porter_tend(struct porter *porter, int64_t now_ns);
/* The process, for the log; 0: there is none. */
int porter_process(const struct porter *porter);

/*
 * Receive what fits of the first message, or of the stream up to the next descriptors, without
 * closing any: a message with descriptors stays where it is. As recv() with MSG_DONTWAIT; -EBADMSG:
 * there are descriptors. take: what was received leaves the socket.
 */
ptrdiff_t porter_receive(int connection, void *bytes, size_t room, bool take);
/* Ask the kernel to refuse descriptors on connections to that socket (from Linux 6.16 on). */
void porter_refuse_descriptors(int listener);

#endif
