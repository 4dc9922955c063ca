/* SPDX-License-Identifier: MIT */
/*
 * The control room: programs that want to command connect to NAME.control and become controllers.
 * Its thread accepts them, looks at their credentials and rights, and makes each a memory of its
 * own; the engine's thread takes them from here. Nothing that comes over the socket is believed.
 *
 * Room src/memory/control: the control socket: connections, credentials, rights.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/memory/shm/controller.h"

struct bus_counter;
struct config;
struct control;
struct log;
struct porter;

struct control_setup {
	const struct config *config;
	int directory;        /* owsd's; stays open as long as the control room */
	const char *instance; /* the caller holds its lock */
	struct log *log;
	struct porter *porter;   /* stays as long as the control room */
	void (*ring)(void *ctx); /* wakes the engine's thread, which then calls control_next() */
	void *ring_ctx;
};
/* Make room for all controllers, and the socket. 0, or a negative errno with the reason in why. */
int control_create(const struct control_setup *setup, struct control **control, char *why,
                   size_t why_size);
/* Start the thread; layout: of the memories. 0 or a negative errno. */
int control_start(struct control *control, const struct controller_layout *layout);
/*
 * End the thread, hang up on all controllers and stop their memories, which stay mapped until
 * control_destroy(): a thread of the engine may end later. NULL: does nothing; so may both be
 * called again.
 */
void control_stop(struct control *control);
void control_destroy(struct control *control);
const struct bus_counter *control_counters(const struct control *control, size_t *n);

/* --- For the engine's thread: these neither block nor allocate ------------------------------- */

/* A controller joins or leaves; what it has is valid until control_done() of its leaving. */
struct control_message {
	unsigned seat;
	bool joins; /* else it leaves */
	struct joining_controller controller;
	int bell; /* eventfd, never read: for edge-triggered epoll */
};
/* The next controller that joins or leaves; the caller calls control_done() before the next. */
bool control_next(struct control *control, struct control_message *message);
void control_done(struct control *control, const struct control_message *message);
/*
 * Have the news rung of the controllers that wait for it, and wake the sleepers of an image, by
 * another thread where there are several; word: of the image, which counts its news.
 */
void control_news(struct control *control, const uint32_t *word);
/* The engine ends: refuse all sets from here on. What was set before, the next step finds. */
void control_end(struct control *control);

/* --- A reload, by the supervisor ------------------------------------------------------------- */

/* A bell (hal/base/bell.h) that rings when a program asks for a reload. */
int control_asked_bell(const struct control *control);
/* Does a program wait for a reload? Silences the bell. */
bool control_asked(struct control *control);
/*
 * A reload begins for all that ask by now; the others wait for the next. control_answer() ends it:
 * answers those programs and hangs up on them. err: 0, or why it was refused; why: the same in
 * words, or with err 0 what the file is warned of, "": of nothing.
 */
void control_take_askers(struct control *control);
void control_answer(struct control *control, int err, const char *why);

/*
 * Make the memories and rights of another configuration for all controllers. None joins or leaves
 * until control_reloaded(), which the caller has to call.
 */
void control_prepare(struct control *control, const struct config *config,
                     const struct controller_layout *layout);
/*
 * The engine's thread, after control_next() had no more and before it adopts: the next controller
 * at or after *seat that has joined, with its new memory and rights; *seat is then the one after
 * it. A controller for whom there was no room is not among them, and owsd hangs up on it.
 */
bool control_prepared(struct control *control, unsigned *seat, struct control_message *message);
/* The engine has adopted, and uses the old memories no more: send the controllers the new ones. */
void control_reloaded(struct control *control);
/*
 * The new image is in place, and the old one is retired: ring the news of all controllers. They
 * said in the memory of before that they wait.
 */
void control_replaced(struct control *control);
