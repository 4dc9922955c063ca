/* SPDX-License-Identifier: MIT */
/*
 * The connections of clients: whole requests out, answers in. None of them holds up the others: one
 * that stops in the middle of a request, or does not take its answers, is closed. When all places
 * are taken, that which has been silent for longest is; an address has half of the places at most.
 */
#pragma once

#include "src/faces/kit/face.h"
#include "src/faces/kit/listeners.h"
#include "src/faces/modbus/answer.h"
#include "src/ground/service/budget.h"

#define CLIENTS_LATE_NS (5 * NS_PER_S) /* for the rest of a request, or of an answer */

struct client {
	bool used;
	int fd;
	struct listen_address from;
	int64_t heard_ns; /* its last request, or when it came */
	int64_t came_ns;  /* the first byte of its next request came later */
	int64_t next_ns;  /* that of those behind it */
	int64_t empty_ns; /* nothing was left to receive then */
	int64_t blind_ns; /* until then its answers alone were watched for */
	int64_t late_ns;  /* when it is closed; 0: it owes nothing */
	uint64_t pass;    /* epoll reported it last in this one */
	struct budget budget;
	size_t in_len, out_len, out_at;
	uint8_t in[2 * FRAME_MOST], out[FRAME_MOST];
};

struct clients {
	struct face *face;
	int epoll; /* readable when clients_take() has something to do */
	struct listeners listeners;
	unsigned most, count;
	uint64_t pass, whole_pass; /* looks at epoll; the last that saw all who were ready, */
	int64_t whole_ns;          /* and its time */
	int64_t nobody_ns;         /* nobody waited at a listener then */
	int64_t resumed_ns;        /* what epoll did not report before may have waited */
	int64_t pause_ns;          /* no descriptor was left: listen again then; 0: it listens */
	int full_err;              /* why; 0: since then somebody was accepted */
	uint64_t requests, refused;
	struct client places[CONFIG_MODBUS_CLIENTS];
	/* Makes the answer to a request of that client. */
	size_t (*answer)(void *ctx, const struct client *client, const uint8_t *request,
	                 uint8_t answer[FRAME_MOST]);
	void *ctx;
};

/* 0 or a negative errno. */
int clients_open(struct clients *c);
/* Listen where the file says now. Connections stay, but for those above Clients. */
void clients_follow(struct clients *c, const struct config_modbus *options, int64_t now_ns);
/* Accept, receive, answer. Never blocks. */
void clients_take(struct clients *c);
/* Close who is late, and listen again; when that is to be done next. */
int64_t clients_tick(struct clients *c, int64_t now_ns);
void clients_close(struct clients *c);
