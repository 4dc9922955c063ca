/* SPDX-License-Identifier: MIT */
/* The socket of the connector: requests of several commands, and their replies. */
#pragma once

#include "hal/wire/link.h"

/* Of struct w1_netlink_cmd. */
enum w1_code {
	W1_READ,
	W1_WRITE,
	W1_SEARCH,
	W1_TOUCH = 4, /* each bit of the data is a slot; a 1 reads */
	W1_RESET = 5, /* status 255: no device answered */
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
	bool (*has_master)(void *ctx, uint32_t master);
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
 * The numbers of all masters, sorted. Their count, or -ETIMEDOUT: no driver serves w1 there; else
 * as sendto(2) says.
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
