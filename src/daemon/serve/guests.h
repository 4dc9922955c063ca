/* SPDX-License-Identifier: MIT */
/*
 * The two bounded queues between the server's thread and the engine's: requests there, answers
 * back. Neither side blocks; the engine rings an eventfd, and only while the server sleeps.
 */
#pragma once

#include "hal/base/ring.h"
#include "src/daemon/engine/guest.h"

struct guests_message {
	struct engine_guest *guest;
	bool released; /* the bus has returned the guest's memory; else: the guest's answer */
};

struct guests {
	struct engine_guests port;   /* the engine's side */
	struct ring asked, answered; /* the places of requests and answers in use */
	struct engine_guest **requests;
	struct guests_message *answers;
	uint32_t sleeping;
	int wake_fd;
	void (*ring)(void *ctx);
	void *ring_ctx;
};

/* Make room for `most` requests at a time. ring wakes the engine. 0 or a negative errno. */
int guests_create(struct guests *guests, unsigned most, void (*ring)(void *ctx), void *ring_ctx);
void guests_destroy(struct guests *guests);

/* The server's side. */
void guests_ask(struct guests *guests, struct engine_guest *guest);
bool guests_next(struct guests *guests, struct guests_message *message);
/*
 * Called before and after a wait for wake_fd, which is watched edge-triggered and so never read.
 * guests_sleep() returns false when a message has come already.
 */
bool guests_sleep(struct guests *guests);
void guests_awake(struct guests *guests);
/* Wake the server, from any thread. */
void guests_wake(struct guests *guests);
