/* SPDX-License-Identifier: MIT */
/*
 * The kernel's 1-Wire core behind a netlink socket, for tests: masters 1, 2, ... are the wires of
 * wire_net (wire_link.h). The model works when the host waits on the socket, on the host's clock,
 * and replies as Linux 6.1 was seen to. It reports what is wrong with a request by errors of its
 * own.
 */
#pragma once

#include "tests/unit/aid/wire_link.h"

struct w1_core {
	struct host *host;
	int fd;             /* the core's end of the pair; -1: none */
	int socket_error;   /* the next sockets are refused */
	unsigned masters;   /* 0: the module is gone and nothing is answered */
	unsigned gone;      /* the number of a master that is gone */
	bool intrudes;      /* another program selects another device before each request */
	bool spreads;       /* each reply in a datagram of its own */
	unsigned silent;    /* so many requests are carried out, but not answered */
	unsigned late;      /* so many of these answers come after the answer to the next request */
	unsigned garbage;   /* so many answers are cut short */
	unsigned scrambles; /* so many answers have one byte changed, by the numbers of seed */
	unsigned seed;
	unsigned refuses; /* so many requests are answered by a status EINVAL alone */
	unsigned requests, searches, alarm_searches, sockets;
	unsigned commands[8]; /* how many commands of each code */
	uint8_t kept[4096];   /* the answers that come late */
	size_t kept_n;
};

extern struct w1_core w1_core;
/* Take the place of the socket, after wire_init(). */
void w1_core_start(struct host *host, unsigned masters);
void w1_core_stop(void);
