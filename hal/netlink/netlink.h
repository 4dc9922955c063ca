/* SPDX-License-Identifier: MIT */
/*
 * The target "w1:netlink": the kernel's 1-Wire masters as links, over the netlink connector. The
 * parts:
 *
 *   talk.c    the socket; requests of several commands and their replies
 *   link.c    one master as a link: a transaction is gathered into one request
 *   search.c  searches, made of slots whose direction is chosen before
 *   master.c  the masters there are; sysfs in place of a refused netlink
 *   bus.c     the target "w1" of both, masters that come later
 *
 * Wire format and what replies mean: the kernel's Documentation/w1/w1-netlink.rst, and seen on
 * Linux 6.1. The kernel carries out the commands of one request with the master's bus locked, so
 * that neither its own search nor another program comes between.
 */
#ifndef HAL_NETLINK_H
#define HAL_NETLINK_H

#include "hal/w1/link.h"

/* Of struct w1_netlink_cmd. */
enum w1_code {
	W1_READ,
	W1_WRITE,
	W1_SEARCH,
	W1_TOUCH = 4, /* each bit of the data is a slot; a 1 reads */
	W1_RESET = 5, /* status 255: nobody answered */
};

#define W1_STATUS_NOBODY 255
#define W1_REQUEST_MAX 1024
#define W1_COMMANDS 16

/* A request: commands for one master, carried out without a break. */
struct w1_request {
	uint32_t master;
	size_t n;       /* bytes so far */
	unsigned count; /* commands so far */
	struct {
		uint8_t code, status;
		uint16_t size; /* of its data */
		uint8_t *in;   /* READ, TOUCH: where what was read goes */
	} command[W1_COMMANDS];
	uint8_t bytes[W1_REQUEST_MAX];
	/* SEARCH: told of each device. */
	link_found *found;
	void *ctx;
};

struct w1_talk {
	const struct bus_env *env;
	/* Is there still such a master? Asked when a reply takes long. */
	bool (*there)(void *ctx, uint32_t master);
	void *ctx;
	int fd; /* -1: closed */
	uint32_t seq;
	uint64_t syscalls;
	uint8_t in[16384]; /* one datagram */
};

/* Makes the socket: a descriptor or -errno. Tests put another in its place. */
extern int (*w1_socket)(void);

/* 0 or -errno, as socket(2) and bind(2) say. */
int w1_talk_open(struct w1_talk *talk);
void w1_talk_close(struct w1_talk *talk);
/*
 * The numbers of all masters, sorted. Their count, or -ETIMEDOUT: nobody serves w1 there; else as
 * sendto(2) says.
 */
int w1_talk_masters(struct w1_talk *talk, uint32_t *numbers, unsigned room);

void w1_request_begin(struct w1_request *request, uint32_t master);
/* -EMSGSIZE: no room for it. data may be NULL (READ). */
int w1_request_add(struct w1_request *request, enum w1_code code, const uint8_t *data, size_t n,
                   uint8_t *in);
/*
 * Sends it and waits for all replies. 0: the statuses are there, and what was read;
 *   -ENODEV the master is gone, -ETIMEDOUT no reply came, -EIO replies were lost, -EPROTO a reply
 *   that makes no sense, -ECANCELED
 */
int w1_request_run(struct w1_talk *talk, struct w1_request *request);

struct w1_netlink;

/* A device that was found, for searches to guess with. */
struct w1_seen {
	uint8_t rom[8];
	uint8_t channel;
};

struct w1_netlink_link {
	struct link link;
	struct w1_netlink *netlink;
	uint32_t number; /* of w1_bus_masterN */
	bool sent;       /* since the last reset a request went out */
	int next_slot;   /* verify() has read it already; -1: not */
	unsigned alarm_searches;
	struct w1_request request;
	struct link_cost cost;
};

struct w1_netlink {
	struct link_master master;
	struct w1_talk talk;
	unsigned only; /* w1_bus_masterN; 0: all */
	unsigned count;
	struct w1_netlink_link links[W1_MASTERS];
	unsigned seen_count;
	struct w1_seen seen[DEVICE_MAX];
	struct w1_master *sysfs; /* target w1's, in case netlink is refused */
	bool refused, told;
	bool answered;   /* once at least */
	int64_t look_ns; /* when to look for masters that came later */
};

extern const struct link_ops w1_netlink_link_ops;
extern const struct link_master_ops w1_netlink_master;

/* Is it "netlink", "netlink/...", of which this bus is? */
bool w1_is_netlink(const char *where);
/* Masters that came since; how many. */
unsigned w1_netlink_look(struct w1_netlink *netlink);

/*
 * link.c: runs a request, which is empty afterwards. -EHOSTDOWN nobody answered its reset,
 * -EIO also a command that the kernel refused; else as w1_request_run.
 */
int w1_netlink_run(struct w1_netlink_link *link, struct w1_request *request);

/* search.c: as the slots of link_ops. */
int w1_netlink_verify(struct link *link, const uint8_t rom[8], bool alarm);
int w1_netlink_search(struct link *link, bool alarm, uint8_t family, link_found *found, void *ctx);

#endif
